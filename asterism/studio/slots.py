"""Designs A, B and C that are kept beside each other."""

from __future__ import annotations

from typing import Any

from asterism.results.compared import COMPARED_KEYS
from asterism.studio.document import Document
from asterism.studio.request import RequestError
from asterism.studio.shown import Shown

SLOTS = ("A", "B", "C")


class Slots:
    """Three places for states of the open design, with their forms and numbers."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[dict[str, Any], bytes | None, dict[str, Any]]] = {}

    def keep(self, slot: str, document: Document, shown: Shown) -> None:
        """Keep the design that is shown."""
        numbers = {key: shown.numbers.get(key) for key in COMPARED_KEYS}
        data = {"name": document.path.stem, "revision": document.revision, **numbers}
        self._kept[slot] = (document.table, shown.snapshots.get(document.revision), data)

    def get(self, slot: str) -> tuple[dict[str, Any], bytes | None]:
        """Table and form of the design in a slot.

        Raises
        ------
        RequestError
            The slot is empty.
        """
        if slot not in self._kept:
            raise RequestError(f"slot {slot} is empty: keep a design there first")
        table, snapshot, _ = self._kept[slot]
        return table, snapshot

    def drop(self, slot: str) -> None:
        """Empty a slot."""
        self._kept.pop(slot, None)

    def data(self) -> dict[str, Any]:
        """Names and numbers by slot, null for an empty one."""
        return {slot: self._kept[slot][2] if slot in self._kept else None for slot in SLOTS}
