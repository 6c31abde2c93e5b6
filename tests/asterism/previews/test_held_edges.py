"""Edges on a curve of targets in both models: affine targets are those of scale and offset, others are met."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.discrete.model.discrete_model import pin_constraints
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.session import Preview
from tests.asterism.previews.laws import plain_law

TURN = 2.0 * np.pi * np.arange(30) / 30
RING = 40.0 * np.column_stack([np.cos(TURN), np.sin(TURN)])
WAVE = np.column_stack([0.8 * RING, 4.0 * np.cos(2.0 * TURN)])


def sheet(**pins: Any) -> Design:
    data = gallery.load("tube").to_dict() | {"border": {"polygon_mm": RING.tolist()}}
    return Design.from_dict(data | {"pins": [{"where": "border"} | pins]})


def affine() -> tuple[Design, Design]:
    places = np.column_stack([0.8 * RING, np.zeros(30)]) + np.array([1.0, 2.0, 3.0])
    return sheet(scale=0.8, offset_mm=[1.0, 2.0, 3.0]), sheet(target_mm=places.tolist())


def test_affine_targets_give_the_same_sheets() -> None:
    by_scale, by_targets = (Preview(design, plain_law()) for design in affine())
    inner = 0.7 * RING
    np.testing.assert_allclose(by_targets.at(inner).smooth, by_scale.at(inner).smooth, atol=1e-5)
    plans = [layout(design) for design in affine()]
    mesh = mesh_layout(plans[0], 4.0)
    one, other = (pin_constraints(plan, mesh) for plan in plans)
    np.testing.assert_array_equal(one.held, other.held)
    np.testing.assert_allclose(one.target, other.target, atol=1e-9)


def test_both_models_hold_the_border_on_the_curve() -> None:
    design = sheet(target_mm=WAVE.tolist())
    plan, preview = layout(design), Preview(design, plain_law())
    assert preview.equilibrium.is_minimum
    assert np.abs(preview.at(RING).smooth - WAVE).max() < 0.4
    mesh = mesh_layout(plan, 4.0)
    supports = pin_constraints(plan, mesh)
    held = supports.held.all(axis=1)
    angle = np.arctan2(mesh.points[held, 1], mesh.points[held, 0])
    np.testing.assert_allclose(supports.target[held, 2], 4.0 * np.cos(2.0 * angle), atol=0.03)
