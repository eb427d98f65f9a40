"""Errors of a call, a map or a scene; each message is one sentence for the user."""


class SceneError(Exception):
    """Bad input: nothing is written, status 2."""
