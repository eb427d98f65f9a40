"""Entry point of ``python -m wingcrack_verify``."""

import sys

from wingcrack_verify.cli import main

sys.exit(main())
