"""Loops run without a folder for their machine code, on a full disk, from damaged files, and uncompiled."""

from __future__ import annotations

import errno
import importlib
import sys
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


@pytest.mark.slow
@pytest.mark.parametrize(("ending", "kept_bytes"), [(".nbi", 0), (".nbi", 40), (".nbc", 1000)])
def test_from_damaged_files(
    ending: str, kept_bytes: int, module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are made anew: a later run reads them again."""
    assert total(module) == 6.0
    (file,) = tmp_path.rglob(f"*{ending}")
    whole = file.stat().st_size
    file.write_bytes(file.read_bytes()[:kept_bytes])
    monkeypatch.delitem(sys.modules, module)
    assert total(module) == 6.0 and file.stat().st_size == whole


def test_uncompiled(module: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As numba's setting NUMBA_DISABLE_JIT asks for."""
    from numba import config

    monkeypatch.setattr(config, "DISABLE_JIT", True)
    assert total(module) == 6.0
