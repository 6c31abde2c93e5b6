"""`pattern` states the order of its rooms; `tests/test_rooms.py` keeps imports to it."""

from __future__ import annotations

from asterism import pattern
from tests.test_rooms import ORDER


def test_the_docstring_states_the_order() -> None:
    order = [room for row in ORDER["pattern"] for room in row]
    assert [line for line in (pattern.__doc__ or "").splitlines() if line in order] == order
