"""Entry of ``python -m wingcrack_view``."""

import sys

from wingcrack_view.cli import main

if __name__ == "__main__":
    sys.exit(main())
