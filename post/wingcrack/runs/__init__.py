"""Runs and their scenes in Python."""
