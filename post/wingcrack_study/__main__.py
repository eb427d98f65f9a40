"""Entry point of ``python -m wingcrack_study``."""

import sys

from wingcrack_study.cli import main

# Processes of a cluster load this module again, under another name.
if __name__ == "__main__":
    sys.exit(main())
