"""A campaign without processes of its own: to start one takes a second."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import pytest

from asterism.homogenize.campaign.workers import SubmitAll


@contextmanager
def workers(jobs: int) -> Iterator[SubmitAll]:
    """In place of `homogenize.campaign.workers.local_workers`: this process solves the cells, in their order."""

    def submit_all(function: Callable[..., Any], arguments: Sequence[tuple[Any, ...]]) -> Iterator[tuple[int, Any]]:
        for number, each in enumerate(arguments):
            yield number, function(*each)

    yield submit_all


def use(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let campaigns solve their cells in this process until the test ends."""
    monkeypatch.setattr("asterism.homogenize.campaign.workers.local_workers", workers)
