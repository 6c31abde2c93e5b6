"""A state of one mesh carried to a finer mesh without parts passing through each other."""

from __future__ import annotations

from discrete.model.contact_model import ContactModel
from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State
from discrete.release.prolongation import prolong, prolong_linearly


def prolong_without_intersection(coarse: DiscreteModel, state: State, fine: ContactModel) -> State | None:
    """The fine state of `prolong`, or as much of it as can be reached from the coarse triangles; None if neither can.

    The smooth surface is the better start, but between the vertices of the coarse mesh nothing keeps its parts apart.
    The coarse triangles were apart; fine triangles across their edges may still come too close.
    """
    smooth = prolong(coarse, state, fine)
    if fine.contact.is_intersection_free(smooth.positions):
        return smooth
    flat = prolong_linearly(coarse, state, fine)
    if fine.contact.is_intersection_free(flat.positions):
        return fine.reachable_state(flat, smooth)
    return None
