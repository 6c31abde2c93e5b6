"""Snapshots of a preview, and the other forms that it has met."""

from __future__ import annotations

import pickle
from functools import partial
from typing import Any

import numpy as np
import pytest

from asterism.equilibrium.errors import Error
from asterism.pattern import gallery
from asterism.previews.session import Preview
from tests.asterism.previews import designs

edited = partial(designs.edited, mesh={"edge_mm": 4.0})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "change"), [("tube", {"stars": {"thickness_mm": 0.42}}), ("dome", {"border": {"rings": 2}})]
)
def test_a_preview_goes_back_to_a_snapshot(name: str, change: dict[str, Any]) -> None:
    start = edited(name)
    preview = Preview(start)
    shape, snapshot = preview.shape(), pickle.loads(pickle.dumps(preview.snapshot()))
    preview.update(edited(name, **change))
    assert preview.restore(snapshot).name == "equilibrium"
    assert preview.design == start and preview.equilibrium.is_minimum
    assert preview.shape().positions == pytest.approx(shape.positions, abs=1e-6)
    other = Preview(edited(name, **change))
    other.restore(snapshot)
    assert other.shape().height_mm == pytest.approx(shape.height_mm, rel=1e-8)


@pytest.mark.slow
def test_undo_restores_the_form_that_a_sheet_had() -> None:
    preview = Preview(edited("dome", pins=[{"where": "border", "scale": 0.7}]))
    snapshot, energy = preview.snapshot(), preview.equilibrium.energy
    preview.flip()
    assert preview.equilibrium.energy != pytest.approx(energy, rel=1e-6)
    preview.restore(snapshot)
    assert preview.equilibrium.energy == pytest.approx(energy, rel=1e-9)


def test_a_snapshot_does_not_change() -> None:
    preview = Preview(edited("dome"))
    snapshot = preview.snapshot()
    with pytest.raises(ValueError, match="read-only"):
        snapshot.x[0] = 0.0
    linear = next(preview.edit(edited("dome", stars={"thickness_mm": 0.4})))
    assert preview.snapshot().x == pytest.approx(snapshot.x) and linear.x is not snapshot.x


@pytest.mark.slow
def test_snapshots_of_other_meshes_are_refused() -> None:
    fine, coarse = Preview(edited("dome"), triangles=150), Preview(edited("dome"), triangles=60)
    before = coarse.state
    with pytest.raises(Error, match="another mesh"):
        coarse.restore(fine.snapshot())
    assert coarse.state is before
    with pytest.raises(TypeError):
        coarse.restore(before)  # type: ignore[arg-type]


@pytest.mark.slow
def test_other_forms_are_shown_and_left_again() -> None:
    """A snapshot of the design keeps them, one of another design has none."""
    start = gallery.load("fig8-l-increasing")
    preview, other = Preview(start), Preview(designs.edited("fig8-l-increasing", stars={"thickness_mm": 0.42}))
    preview.restore(preview.snapshot())
    forms = preview.forms
    assert len(forms) == 1
    for number in (-1, 1, 0.5, True):
        with pytest.raises(ValueError, match="number"):
            preview.show_form(number)  # type: ignore[arg-type]
    first, energy = preview.equilibrium.energy, forms[0].energy_n_mm
    preview.show_form(0)
    assert preview.equilibrium.energy == pytest.approx(energy, rel=1e-6) and preview.equilibrium.is_minimum
    back = [number for number, form in enumerate(preview.forms) if np.isclose(form.energy_n_mm, first, rtol=1e-6)]
    preview.show_form(back[0])
    assert preview.equilibrium.energy == pytest.approx(first, rel=1e-6)
    preview.restore(other.snapshot())
    assert not preview.forms
