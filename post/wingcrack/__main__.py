"""Entry of ``python -m wingcrack``: the command line, as ``./wingcrack`` has it."""

import sys

from wingcrack.command_line.entry import program

# Processes of a cluster load this module again, under another name.
if __name__ == "__main__":
    sys.exit(program())
