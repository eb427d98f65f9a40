"""Verification: runs the cases of ``verification/``, judges every number and writes the report."""
