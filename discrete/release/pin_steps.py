"""Pins that take hold of the sheet after its release, in steps."""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.pattern.geometry.rigid_fit import rigid_fit

# 1: total weight of the free vertices over that of the held ones, in the rigid fit of a free sheet to its pins; it
# decides a rotation that the pins leave undetermined
FREE_VERTEX_WEIGHT = 1e-6


def model_with_pins_until(model: DiscreteModel, step: int) -> DiscreteModel:
    """The model with the pins of the steps up to `step`; the model itself if all its pins act from the print on."""
    if model.layout.pin_steps == (0,):
        return model
    kept = [i for i, pin in enumerate(model.layout.pins) if pin.is_active(step)]
    if len(kept) == len(model.layout.pins):
        return copy.copy(model)  # `attach_pins` replaces the constraints of the copy
    layout = replace(model.layout, pins=tuple(model.layout.pins[i] for i in kept))
    mesh = replace(model.mesh, pin_vertices=tuple(model.mesh.pin_vertices[i] for i in kept))
    return type(model)(model.design, layout, mesh)


def attach_pins(model: DiscreteModel, state: State, was_free: bool) -> State:
    """Attach the pins of the model to a state. From there they move to their targets with `model.pin_progress`.

    A sheet without supports (`was_free`) first moves rigidly to where its pins are nearest to their targets.
    """
    model.set_release(1.0)
    if was_free:
        state = _fitted_to_pins(model, state)
    start = np.where(model.constraints.held, state.positions, model.constraints.printed)
    model.constraints = replace(model.constraints, printed=start)
    model.pin_progress = 0.0
    return state


def _fitted_to_pins(model: DiscreteModel, state: State) -> State:
    """The state moved rigidly so that the vertices with most held components are closest to their targets (Kabsch).

    If the pins leave a rotation undetermined, the printed positions of the other vertices decide: the plastic is up.
    """
    components = model.constraints.held.sum(axis=1)
    fitted = components == components.max()
    weight = np.where(fitted, 1.0 / fitted.sum(), FREE_VERTEX_WEIGHT / model.n_vertices)
    rotation, shift = rigid_fit(state.positions, model.constraints.target, weight)
    return state.rotated(rotation, shift)
