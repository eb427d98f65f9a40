"""The command line for the launcher: start.py [--ask] COMMAND [ARGUMENT ...].

With --ask it only understands the arguments: it prints the help that they ask for, or refuses them
with status 2. That takes nothing but Python itself, so the launcher asks before it installs or
builds anything. To be called with `python -I`: modules come from post/ and from the environment of
that Python, never from the folder where the user happens to be.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "post"))

from wingcrack.command_line.entry import program

# Processes of a cluster load this file again, under another name.
if __name__ == "__main__":
    asks = sys.argv[1:2] == ["--ask"]
    if asks:
        del sys.argv[1]
    sys.exit(program(only_understands=asks))
