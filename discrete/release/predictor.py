"""Predictor of the release: the state after the next step, from the states after the last two."""

from __future__ import annotations

from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State
from discrete.release.extrapolation import extrapolate


def predict_release(model: DiscreteModel, before: tuple[float, State], last: tuple[float, State]) -> State:
    """The state from which the minimisation at the model's release begins.

    The rotations between the two states go on in proportion to the released share. The prediction is used if its energy
    is lower than that of the last state, which is not so where the sheet has just left a saddle.

    Parameters
    ----------
    before, last : released shares, 0 to 1, and their equilibria.

    Returns
    -------
    The prediction, or the last state; the supports are applied.
    """
    state = model.apply_supports(last[1])
    share = (model.release - last[0]) / (last[0] - before[0])
    predicted = model.apply_supports(extrapolate(model, before[1], last[1], share))
    energies = (sum(model.energies(each).values()) for each in (predicted, state))
    return predicted if next(energies) < next(energies) else state
