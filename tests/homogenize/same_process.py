"""A campaign without processes of its own: to start one takes a second."""

from __future__ import annotations

from contextlib import AbstractContextManager

import pytest

from asterism.homogenize.campaign.workers import SubmitAll, this_process


def workers(jobs: int) -> AbstractContextManager[SubmitAll]:
    """In place of `homogenize.campaign.workers.local_workers`: this process solves the cells, in their order."""
    return this_process()


def use(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let campaigns solve their cells in this process until the test ends."""
    monkeypatch.setattr("asterism.homogenize.campaign.workers.local_workers", workers)
