"""Machine code on disk counts for the formulas that it was compiled from."""

from __future__ import annotations

import errno
import importlib
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.equilibrium import compiled
from asterism.equilibrium.compiled import has_machine_code, loop, sum_formula
from asterism.equilibrium.threads import _openblas, one_blas_thread


def test_sums_in_another_order_differ_by_rounding_and_keep_nan() -> None:
    @sum_formula
    def total(values):  # type: ignore[no-untyped-def]
        s = 0.0
        for value in values:
            s += value
        return s

    @loop
    def compiled(values):  # type: ignore[no-untyped-def]
        return total(values)

    values = 1.0 / np.arange(1.0, 1000.0)
    assert compiled(values) == pytest.approx(float(values.sum()), rel=1e-14)
    assert np.isnan(compiled(np.r_[values, np.nan])) and np.isinf(compiled(np.r_[values, np.inf]))


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


def test_changed_formulas_have_no_machine_code(module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "looping"
    assert not has_machine_code(package)
    assert total(module) == 6.0
    assert has_machine_code(package)
    (package / "more.py").write_text("@formula\ndef twice(x): ...\n")
    compiled._digest.cache_clear()  # as in a later run
    assert not has_machine_code(package)


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
    file.write_bytes(file.read_bytes()[:kept_bytes])
    monkeypatch.delitem(sys.modules, module)
    assert total(module) == 6.0 and file.stat().st_size > 2 * kept_bytes


def test_uncompiled(module: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As numba's setting NUMBA_DISABLE_JIT asks for."""
    from numba import config

    monkeypatch.setattr(config, "DISABLE_JIT", True)
    assert total(module) == 6.0


def threads() -> list[int]:
    return [library["num_threads"] for library in _openblas().info()]


def test_threads_come_back_when_the_last_one_leaves() -> None:
    """Two Python threads may be within at once, and leave in the order in which they came."""
    if not threads():
        pytest.skip("numpy and scipy do not use OpenBLAS here")
    with _openblas().limit(limits=2):
        before = threads()
        first, second = ExitStack(), ExitStack()
        first.enter_context(one_blas_thread())
        second.enter_context(one_blas_thread())
        assert set(threads()) == {1}
        first.close()
        assert set(threads()) == {1}
        second.close()
        assert threads() == before
