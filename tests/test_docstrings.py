"""Every example in a docstring runs and gives what it shows."""

from __future__ import annotations

import doctest
import importlib
from pathlib import Path

import numpy as np
import pytest

from tests.test_rooms import FILES

MODULES = [name for name, file in FILES.items() if ">>> " in file.read_text(encoding="utf-8")]
# examples that take seconds
LONG = {
    *("asterism.exact.spread", "asterism.print.export", "asterism.verification.both_starts"),
    *("asterism.fitting.fit", "asterism.fitting.solve_for", "asterism.measure.compare.compare"),
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in LONG else ()) for name in MODULES]
)
def test_examples_in_docstrings_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with np.printoptions(precision=4, suppress=True):
        result = doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS)
    assert result.attempted > 0 and result.failed == 0
