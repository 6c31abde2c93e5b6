"""What waits for an engine: the newest edit replaces older ones, and loses nothing that they say."""

from __future__ import annotations

import queue
from typing import Any

from asterism.studio.inbox import Inbox, merged
from asterism.studio.messages import Edit, Stop


def waiting(*messages: Any) -> list[Any]:
    """What an inbox hands out that got these messages before anybody asked."""
    pipe: queue.Queue[Any] = queue.Queue()
    for message in (*messages, Stop()):
        pipe.put(message)
    inbox = Inbox(pipe.get)
    with inbox._changed:
        assert inbox._changed.wait_for(lambda: inbox.is_closed, 10.0)
    return list(inbox._waiting)


def test_an_edit_of_a_design_that_waits_to_be_opened_opens_it() -> None:
    (edit,) = waiting(Edit(1, {"name": "a"}, is_opened=True, snapshot=b"form"), Edit(2, is_dragging=True))
    assert (edit.seq, edit.design, edit.is_opened, edit.is_dragging) == (2, {"name": "a"}, True, True)
    assert edit.snapshot == b"form"
    (edit,) = waiting(Edit(1, {"name": "a"}, is_opened=True, snapshot=b"form"), Edit(2, {"name": "b"}, is_opened=True))
    assert (edit.design, edit.snapshot) == ({"name": "b"}, None)


def test_an_edit_that_follows_an_opened_design_opens_nothing() -> None:
    edit = merged(Edit(1, {"name": "a"}, is_opened=True, snapshot=b"form"), Edit(2))
    assert (edit.design, edit.is_opened, edit.snapshot) == ({"name": "a"}, False, b"form")
