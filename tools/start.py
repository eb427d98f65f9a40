"""Start a Python package of post/: start.py [--ask] PACKAGE [ARGUMENT ...].

With --ask it only understands the arguments: it prints the help that they ask for, or refuses them
with status 2. That takes nothing but Python itself, so the launcher asks before it installs or
builds anything. To be called with `python -I`: modules come from post/ and from the environment of
that Python, never from the folder where the user happens to be.
"""

import importlib
import runpy
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent


def main() -> int:
    """Return the exit status of what is started, or 3 if the environment lacks a package for it."""
    asks = sys.argv[1] == "--ask"
    package, *arguments = sys.argv[2 if asks else 1 :]
    sys.path.insert(0, str(TOP / "post"))
    try:
        if asks:
            importlib.import_module(f"{package}.arguments").parse(arguments)
        else:
            sys.argv[1:] = arguments
            runpy.run_module(package, run_name="__main__", alter_sys=True)
    except ImportError as reason:
        if reason.name is None or reason.name.startswith("wingcrack"):
            raise
        said = str(reason).splitlines()[0]
        print(
            f"wingcrack: a Python package cannot be loaded ({said}); remove the folder"
            f" {TOP / '.venv'} and call again, which installs all of them",
            file=sys.stderr,
        )
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main())
