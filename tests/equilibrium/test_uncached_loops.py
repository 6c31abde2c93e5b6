"""Loops run without a folder for their machine code, and on a full disk."""

from __future__ import annotations

import errno
import importlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.equilibrium import compiled

SOURCE = """
from asterism.equilibrium.compiled import loop


@loop
def total(values, out):
    for value in values:
        out[0] += value
"""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The name of a module with a loop, which was never imported."""
    (tmp_path / "looping").mkdir()
    name = f"total_{tmp_path.name.replace('-', '_')}"
    (tmp_path / "looping" / f"{name}.py").write_text(SOURCE)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(compiled, "uncached", [])
    return f"looping.{name}"


def total(module: str) -> float:
    out = np.zeros(1)
    importlib.invalidate_caches()
    importlib.import_module(module).total(np.arange(4.0), out)
    return float(out[0])


def test_without_a_folder_that_can_be_written(module: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from numba.core import caching

    monkeypatch.setattr(caching.CacheImpl, "_locator_classes", [])
    assert total(module) == 6.0
    assert compiled.uncached == ["total"]


def test_on_a_full_disk(module: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from numba.core import caching

    tried = []

    def full(self: Any, *overload: Any) -> None:
        tried.append(overload)
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(caching.IndexDataCacheFile, "save", full)
    assert total(module) == 6.0
    assert tried and compiled.uncached == []
