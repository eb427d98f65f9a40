"""Entry of ``python -m wingcrack_scenes``."""

import sys

from wingcrack_scenes.cli import main

if __name__ == "__main__":
    sys.exit(main())
