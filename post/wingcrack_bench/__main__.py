"""Entry point of ``python -m wingcrack_bench``."""

import sys

from wingcrack_bench.cli import main

sys.exit(main())
