"""Prolongation of a state with contact to a finer mesh, without intersections."""

from __future__ import annotations

from asterism.discrete.model.contact_model import ContactModel
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.prolongation import prolong, prolong_linearly


def prolong_without_intersection(coarse: DiscreteModel, state: State, fine: ContactModel) -> State | None:
    """The state of `prolong`, or the part of it that is reachable from the coarse triangles; None if neither exists.

    The smooth surface is the better start, but its parts may intersect between the vertices of the coarse mesh. The
    coarse triangles do not intersect; yet fine triangles across their edges may come closer than contact allows.
    """
    smooth = prolong(coarse, state, fine)
    if fine.contact.is_intersection_free(smooth.positions):
        return smooth
    linear = prolong_linearly(coarse, state, fine)
    if fine.contact.is_intersection_free(linear.positions):
        return fine.reachable_state(linear, smooth)
    return None
