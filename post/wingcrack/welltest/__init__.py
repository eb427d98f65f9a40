"""Well-test analysis: shut-ins of runs and of measured records, their curves, lines and picks.

Modules: `record` reads, `curves` computes, `shut_in` evaluates a fall-off, `panels` draws it.
"""
