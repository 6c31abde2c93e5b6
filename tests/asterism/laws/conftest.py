"""The cells of each test lie beside its files, and commands run in this process."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.asterism.commands import Outcome, command

Asterism = Callable[[list[str]], Outcome]


@pytest.fixture(autouse=True)
def own_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ASTERISM_CELLS", str(tmp_path / "cells"))


@pytest.fixture
def asterism(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Asterism:
    return lambda words: command(words, capsys, monkeypatch)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where commands run."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
