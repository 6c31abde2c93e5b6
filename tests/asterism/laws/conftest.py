"""The cells of each test lie beside its files."""

from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def own_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ASTERISM_CELLS", str(tmp_path / "cells"))
