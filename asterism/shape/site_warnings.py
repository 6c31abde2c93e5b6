"""Warning of entries of a design for lattice sites outside of the sheet."""

from __future__ import annotations

from collections.abc import Iterator

from asterism.pattern.layout.layout import Layout

# a warning lists at most this many sites
MAX_NAMED_SITES = 5


def site_warnings(layout: Layout) -> Iterator[str]:
    """Yield a line if entries of `stars.override` are for sites outside of the sheet."""
    if not (count := len(layout.ignored_sites)):
        return
    named = ", ".join(str(site) for site in layout.ignored_sites[:MAX_NAMED_SITES].tolist())
    more = ", ..." if count > MAX_NAMED_SITES else ""
    entries = "1 entry of stars.override is" if count == 1 else f"{count} entries of stars.override are"
    yield f"{entries} for sites outside of the sheet, and ignored: {named}{more}"
