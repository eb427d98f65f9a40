"""Fracture maps and random networks as scenes: read, examined, repaired on request, written."""
