"""Machine code on disk counts for the formulas that it was compiled from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from asterism.equilibrium.compiled import has_machine_code, loop, sum_formula

LOOPS = """
from asterism.equilibrium.compiled import formula


@formula
def twice(x):
    return 2.0 * x


def total(values):
    s = 0.0
    for value in values:
        s += twice(value)
    return s
"""


def test_changed_formulas_have_no_machine_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "sums"
    package.mkdir()
    (package / "__init__.py").write_text("", encoding="utf-8")
    (package / "total.py").write_text(LOOPS, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    from sums.total import total  # type: ignore[import-not-found]

    assert not has_machine_code(package)
    assert loop(total)(np.array([1.0, 2.0])) == 6.0
    assert has_machine_code(package)
    monkeypatch.setattr("asterism.equilibrium.compiled._digest", lambda package: "of-other-formulas")
    assert not has_machine_code(package)


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
