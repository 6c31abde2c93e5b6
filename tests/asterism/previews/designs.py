"""Designs of the gallery with changes."""

from __future__ import annotations

from typing import Any

from asterism.pattern import gallery
from asterism.pattern.design.design import Design


def edited(name: str, **sections: Any) -> Design:
    """A design of the gallery, with sections that replace its own, or entries (a dict) that replace those there."""
    data = gallery.load(name).to_dict()
    for section, entries in sections.items():
        own = data.get(section)
        data[section] = own | entries if isinstance(own, dict) and isinstance(entries, dict) else entries
    return Design.from_dict(data)
