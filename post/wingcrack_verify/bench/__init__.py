"""The performance measurements: ``./wingcrack bench``."""
