"""Entry of ``python -m wingcrack_docs``."""

import sys

from wingcrack_docs.cli import main

if __name__ == "__main__":
    sys.exit(main())
