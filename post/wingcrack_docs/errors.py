"""What can go wrong with the site; each message is one sentence for the user."""


class PagesError(Exception):
    """FORD ended without its pages; the message has its last sentence."""


class SiteError(Exception):
    """The site could not be built; the messages of MkDocs have been printed."""


class PicturesError(Exception):
    """A scene that does not run to its end, or that has no place in the gallery."""
