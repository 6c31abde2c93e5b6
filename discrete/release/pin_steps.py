"""Pins that take hold of the sheet after its release."""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np

from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State
from pattern.geometry.rigid_fit import rigid_fit

FREE_VERTEX_WEIGHT = 1e-6  # weight of the rest of the sheet where the pins leave a turn undecided


def model_with_pins_until(model: DiscreteModel, step: int) -> DiscreteModel:
    """The model with the pins of the steps up to this one only; itself if all pins hold from the print on."""
    if model.layout.pin_steps == (0,):
        return model
    kept = [i for i, pin in enumerate(model.layout.pins) if pin.is_active(step)]
    if len(kept) == len(model.layout.pins):
        return copy.copy(model)  # its constraints will be its own
    layout = replace(model.layout, pins=tuple(model.layout.pins[i] for i in kept))
    mesh = replace(model.mesh, pin_vertices=tuple(model.mesh.pin_vertices[i] for i in kept))
    return type(model)(model.design, layout, mesh, model.compiled)


def attach_pins(model: DiscreteModel, state: State, was_free: bool) -> State:
    """The state as the model's pins take hold of it: from here they move to their places (`model.pin_progress`).

    A sheet that was free is first laid where its pins are nearest to their places.
    """
    model.set_release(1.0)
    if was_free:
        state = _laid(model, state)
    start = np.where(model.constraints.held, state.positions, model.constraints.printed)
    model.constraints = replace(model.constraints, printed=start)
    model.pin_progress = 0.0
    return state


def _laid(model: DiscreteModel, state: State) -> State:
    """Rigid motion that brings the held components closest to their targets (Kabsch), plastic up if they allow it."""
    components = model.constraints.held.sum(axis=1)
    most = components == components.max()
    weight = np.where(most, 1.0 / most.sum(), FREE_VERTEX_WEIGHT / model.n_vertices)
    rotation, shift = rigid_fit(state.positions, model.constraints.target, weight)
    return State(state.positions @ rotation.T + shift, state.directors @ rotation.T)
