"""Scene files as text: groups and names by the solver's own table, and scenes to start from."""
