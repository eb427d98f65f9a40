"""Entry of ``python -m wingcrack_maps``."""

import sys

from wingcrack_maps.cli import main

if __name__ == "__main__":
    sys.exit(main())
