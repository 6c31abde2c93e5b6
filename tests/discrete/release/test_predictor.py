"""The release begins each step where the last two lead: fewer iterations, and the same equilibrium."""

from __future__ import annotations

import pytest

from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State
from discrete.release import continuation
from discrete.release.predictor import predict_release
from discrete.release.single_mesh import solve_on_mesh
from pattern import gallery
from pattern.design.design import Design
from pattern.layout.build import layout
from pattern.mesh.meshing import mesh_layout


def model(**changes: object) -> DiscreteModel:
    data = gallery.load("bell").to_dict() | {"border": {"rings": 1}, "mesh": {"edge_mm": 5.0}}
    design = Design.from_dict(data | changes)
    plan = layout(design)
    return DiscreteModel(design, plan, mesh_layout(plan, 5.0, design.mesh.kind, design.mesh.seed, design.mesh.graded))


def test_fewer_factorisations_lead_to_the_same_equilibrium(monkeypatch: pytest.MonkeyPatch) -> None:
    predicted = solve_on_mesh(model())
    monkeypatch.setattr(continuation, "predict_release", lambda m, before, last: m.apply_supports(last[1]))
    plain = solve_on_mesh(model())
    assert predicted.factorisations < 0.9 * plain.factorisations
    assert predicted.energies.keys() == plain.energies.keys()
    assert sum(predicted.energies.values()) == pytest.approx(sum(plain.energies.values()), rel=1e-9)


def test_a_prediction_of_higher_energy_is_not_used() -> None:
    """The sheet is at its minimum; from the flat print the rotations would go far beyond it."""
    m = model()
    found = solve_on_mesh(m)
    kept = predict_release(m, (0.1, m.printed_state()), (0.2, found.state))
    assert kept.positions == pytest.approx(m.apply_supports(found.state).positions)


def test_contact_has_no_prediction(monkeypatch: pytest.MonkeyPatch) -> None:
    """A predicted sheet may pass through itself, and contact could not undo this."""
    pytest.importorskip("ipctk")

    def predict(*arguments: object) -> State:
        raise AssertionError("predicted")

    monkeypatch.setattr(continuation, "predict_release", predict)
    assert solve_on_mesh(model(solver={"contact": True})).factorisations > 0
