"""Why a number cannot be measured; each message is one sentence for the reader of the report."""


class CaseError(Exception):
    """A case is wrong in itself: a key, metric, column or row that is not there, a NaN."""
