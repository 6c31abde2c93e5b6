"""The exact shape of the rounded design: its starts, and the minima that the table of an export lists."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.print.export import export
from asterism.print.printed_shape import printed_shape
from tests.asterism.print.jobs import design, job


@pytest.mark.slow
def test_the_exact_shape_of_a_print_has_both_starts_and_lists_both_minima(tmp_path: Path) -> None:
    small = design(fabric={}, stars={"length_mm": 8.0}, border={"rings": 0}, pins=[], mesh={"edge_mm": 6.0})
    shape, change = printed_shape(job(small), preview=False, simulate=True)
    assert shape is not None and change is not None
    (minimum,) = change.minima
    assert minimum.start_names == ["release", "preview"] and minimum.energy_n_mm == shape.summary["energy_n_mm"]
    two = change.changed(minima=[minimum, minimum.changed(distance_percent=7.5, start_names=["preview"])])
    rounded = export(small, tmp_path).summary
    assert "minimum 2" not in rounded.table()
    assert rounded.changed(shape_change=two).table()["minimum 2"].endswith("7.5 % away, from preview")
