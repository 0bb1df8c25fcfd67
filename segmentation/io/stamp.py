"""The time that files are stamped with."""

import os
from datetime import UTC, datetime


def stamp() -> datetime:
    """That of SOURCE_DATE_EPOCH (reproducible-builds.org), or 1970, in UTC: a scan gives the same bytes any day."""
    told = os.environ.get("SOURCE_DATE_EPOCH", "")
    return datetime.fromtimestamp(min(int(told), LAST) if told.isascii() and told.isdigit() else 0, UTC)


LAST = 253402300799
"""The last second of the year 9999."""
