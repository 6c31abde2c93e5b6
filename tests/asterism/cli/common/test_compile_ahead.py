"""The other process starts only if there is something to compile, and does not outlive the block."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import pytest

from asterism.cli.common import compile_ahead
from asterism.cli.common.compile_ahead import WARM_UP, compiling_ahead


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen[bytes]]:
    """The processes that are started; each would take a minute."""
    processes: list[subprocess.Popen[bytes]] = []
    start = subprocess.Popen

    def recorded(*arguments: Any, **options: Any) -> subprocess.Popen[bytes]:
        processes.append(start(*arguments, **options))
        return processes[-1]

    monkeypatch.setattr(compile_ahead.subprocess, "Popen", recorded)
    monkeypatch.setattr(compile_ahead, "WARM_UP", dict.fromkeys(WARM_UP, "import time; time.sleep(60)"))
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    return processes


def test_it_ends_with_the_block(started: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("asterism.equilibrium.compiled.has_machine_code", lambda package: False)
    with pytest.raises(KeyboardInterrupt), compiling_ahead("fem"):
        assert started[0].poll() is None
        raise KeyboardInterrupt
    assert started[0].returncode is not None


def test_without_need_it_does_not_start(
    started: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("asterism.equilibrium.compiled.has_machine_code", lambda package: True)
    with compiling_ahead("discrete"), compiling_ahead(None):
        pass
    monkeypatch.setattr("asterism.equilibrium.compiled.has_machine_code", lambda package: False)
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    with compiling_ahead("discrete"):
        pass
    assert started == []


@pytest.mark.slow
@pytest.mark.parametrize("program", WARM_UP.values(), ids=WARM_UP.keys())
def test_the_programs_run(program: str) -> None:
    subprocess.run([sys.executable, "-c", program], check=True)
