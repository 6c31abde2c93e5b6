"""A state of one mesh carried to a finer mesh without parts passing through each other."""

from __future__ import annotations

from discrete.model.contact_model import ContactModel
from discrete.model.model import Model
from discrete.model.state import State
from discrete.release.prolongation import flatly_prolonged, prolonged


def prolonged_apart(coarse: Model, state: State, fine: ContactModel) -> State | None:
    """The fine state of `prolonged`, or as much of it as can be reached from the coarse triangles; None if neither can.

    The smooth surface is the better start, but between the vertices of the coarse mesh nothing keeps its parts apart.
    The coarse triangles were apart; fine triangles across their edges may still come too close.
    """
    smooth = prolonged(coarse, state, fine)
    if fine.contact.apart(smooth.positions):
        return smooth
    flat = flatly_prolonged(coarse, state, fine)
    if fine.contact.apart(flat.positions):
        return fine.towards(flat, smooth)
    return None
