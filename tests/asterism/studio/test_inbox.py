"""What waits for an engine: the newest edit replaces older ones, and loses nothing that they say."""

from __future__ import annotations

import queue
from typing import Any

from asterism.studio.inbox import Inbox
from asterism.studio.messages import Edit, Flip


def waiting(*messages: Any) -> list[Any]:
    """What an inbox hands out that got these messages before anybody asked."""
    pipe: queue.Queue[Any] = queue.Queue()
    for message in messages:
        pipe.put(message)

    def receive() -> Any:
        try:
            return pipe.get_nowait()
        except queue.Empty:
            raise EOFError from None

    inbox = Inbox(receive)
    with inbox._changed:
        assert inbox._changed.wait_for(lambda: inbox.is_closed, 10.0)
    return list(inbox._waiting)


def test_an_edit_of_a_design_that_waits_to_be_opened_opens_it() -> None:
    opened = Edit(1, {"name": "a"}, is_opened=True, snapshot=b"form")
    (edit,) = waiting(opened, Edit(2, {"name": "b"}, is_dragging=True))
    assert (edit.seq, edit.design, edit.is_opened, edit.is_dragging) == (2, {"name": "b"}, True, True)
    assert edit.snapshot == b"form"
    (edit,) = waiting(opened, Edit(2, {"name": "b"}, is_opened=True))
    assert (edit.design, edit.snapshot) == ({"name": "b"}, None)


def test_an_edit_that_follows_a_search_opens_nothing() -> None:
    opened, flip, edit = waiting(Edit(1, {"name": "a"}, is_opened=True), Flip(2), Edit(3, {"name": "a"}))
    assert opened.is_opened and not edit.is_opened and edit.snapshot is None and flip.seq == 2
