"""Studies: many runs of a scene from one file, with a table of them and figures."""
