"""Studies: many runs of a scene from one file, with a table of them and figures."""

from pathlib import Path

TOP = Path(__file__).resolve().parents[3]
