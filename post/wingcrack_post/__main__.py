"""Entry of ``python -m wingcrack_post``."""

import sys

from wingcrack_post.cli import main

if __name__ == "__main__":
    sys.exit(main())
