"""The line that says what a first run waits for: only where something is compiled, and once."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from asterism.process import compiling
from asterism.process.compiling import (
    WARM_UP,
    announce_compiling,
    clock_without_compiling,
    compiling_ahead,
    signs_while_compiling,
)

pytest.importorskip("numba")

SOURCE = """
from asterism.equilibrium.compiled import formula, loop

@formula
def twice(x):
    return 2 * x

@loop
def first(n):
    return twice(n) + 1

@loop
def second(n):
    return twice(n) + 2
"""


def fresh(folder: Path, name: str) -> ModuleType:
    """The module as a new process imports it; its machine code is kept in a folder beside its file."""
    path = folder / "loops.py"
    if not path.exists():
        path.write_text(SOURCE)
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def said(module: ModuleType) -> list[str]:
    lines: list[str] = []
    with announce_compiling(lines.append):
        assert (module.first(3), module.second(3)) == (7, 8)
    return lines


def test_compiling_is_said_once_and_not_where_machine_code_is_found(tmp_path: Path) -> None:
    lines = said(fresh(tmp_path, "asterism.discrete.loops"))
    assert len(lines) == 1 and lines[0].startswith("compiling the exact model:")
    assert list(tmp_path.rglob("*.nbi"))
    assert said(fresh(tmp_path, "asterism.discrete.loops")) == []


def test_a_clock_stands_still_while_loops_are_compiled_or_read(tmp_path: Path) -> None:
    for name in ("asterism.fem.loops", "asterism.fem.again"):  # the second finds the machine code of the first
        module = fresh(tmp_path, name)
        with clock_without_compiling() as clock:
            begun, by_the_clock = time.perf_counter(), clock()
            module.first(3)
            spent, counted = time.perf_counter() - begun, clock() - by_the_clock
            assert counted < 0.9 * spent, name
            begun, by_the_clock = time.perf_counter(), clock()
            time.sleep(0.05)
            assert 0.05 <= clock() - by_the_clock <= time.perf_counter() - begun


def test_long_compiling_gives_signs_of_life(tmp_path: Path) -> None:
    signs: list[str] = []
    with signs_while_compiling(signs.append, 0.001):
        assert fresh(tmp_path, "asterism.fem.loops").first(3) == 7
    assert signs and "later runs have the code" in signs[0]
    signs.clear()
    with signs_while_compiling(signs.append, 0.001):
        assert fresh(tmp_path, "asterism.fem.loops").first(3) == 7
    assert signs == []


@pytest.mark.parametrize(("has_code", "starts"), [(False, 1), (True, 0)])
def test_another_process_compiles_only_where_it_helps_and_ends_with_the_block(
    has_code: bool, starts: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[subprocess.Popen[bytes]] = []
    start = subprocess.Popen

    def recorded(*arguments: Any, **options: Any) -> subprocess.Popen[bytes]:
        started.append(start(*arguments, **options))
        return started[-1]

    monkeypatch.setattr(compiling.subprocess, "Popen", recorded)
    monkeypatch.setattr(compiling, "WARM_UP", {"fem": "import time; time.sleep(60)"})
    monkeypatch.setattr(compiling, "has_machine_code", lambda folder: has_code)
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    with pytest.raises(KeyboardInterrupt), compiling_ahead("fem"):
        assert [process.poll() for process in started] == [None] * starts
        raise KeyboardInterrupt
    assert all(process.returncode is not None for process in started)


@pytest.mark.slow
@pytest.mark.parametrize("program", WARM_UP.values(), ids=WARM_UP.keys())
def test_the_programs_that_compile_ahead_run(program: str) -> None:
    """Nobody sees if they fail."""
    subprocess.run([sys.executable, "-c", program], check=True)
