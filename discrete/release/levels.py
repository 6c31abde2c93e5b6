"""Search from coarse to fine: the coarsest mesh finds the form, and each finer mesh corrects it.

The search ends on the first mesh on which the estimated error of the shape is within the tolerance of the design, or on
the mesh of the edge that the design gives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce

import numpy as np

from asterism.discrete.model.contact_model import ContactModel, is_intersection_free
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.continuation import Report, prefixed_report, solve_on_mesh
from asterism.discrete.release.equilibrium import Equilibrium
from asterism.discrete.release.ladder import Ladder
from asterism.discrete.release.mesh_error import MeshErrorEstimate, change_percent, mesh_error
from asterism.discrete.release.prolongation import extrapolate, fit_to_surface, prolong, prolong_linearly
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.clock import Clock
from asterism.pattern.geometry.rigid_fit import rigid_fit

SurfaceMap = Callable[[Array], Array]  # printed points (n, 2) mm to points in space (n, 3) mm
# to a tolerance: the softest modes of a sheet without supports hardly change between the two coarsest ones
LEAST_MESHES_OF_FREE_SHEETS = 3
# 1: difference of two energies over the elastic energy, below which two states of one mesh may be one
SAME_STATE_ENERGY = 1e-8
# 1: rms distance of these states after the best rigid motion over the rms radius of the sheet
SAME_STATE_DISTANCE = 1e-4


@dataclass(frozen=True)
class MeshLevel:
    """The shape on one mesh, and its effort."""

    # vertices, iterations, factorisations: their numbers.
    vertices: int
    iterations: int
    factorisations: int
    seconds: dict[str, float]  # wall time by stage
    # rms distance to the shape on the level before, in % of the diameter; None for the first level.
    change_percent: float | None = None


@dataclass
class SharedSearch:
    """The states that a first search has reached on the models of a sheet.

    Two searches that reach one state on a mesh would repeat each other on all finer meshes. A second search with the
    same object therefore ends there, and its result is that of the first, if the first has found a minimum.
    """

    ladder: Ladder  # the models
    ends: list[Equilibrium] = field(default_factory=list)  # the equilibria of the first search; empty before its end
    levels: list[MeshLevel] = field(default_factory=list)  # their efforts
    # number of vertices of the mesh on which the second search reached a state of the first; None before.
    joined_at: int | None = None

    def reaches(self, number: int, end: Equilibrium) -> bool:
        """Whether a second search need not go on from its end on the model of this number, counted from 0."""
        return self.ends[-1].is_minimum and is_same_state(self.ends[number], end)


def is_same_state(first: Equilibrium, second: Equilibrium) -> bool:
    """Whether two ends on one mesh are one state: equal energy and stars, and one shape up to a rigid motion.

    An image of a state under a symmetry of the design is another state, even if it counts as the same form.
    """
    elastic = first.energy - first.energies.get("gravity", 0.0)
    if abs(first.energy - second.energy) > SAME_STATE_ENERGY * elastic:
        return False
    one, other = first.state.positions, second.state.positions
    rotation, shift = rigid_fit(other, one)
    distance = np.linalg.norm(other @ rotation.T + shift - one)
    radius = np.linalg.norm(one - one.mean(axis=0))
    return bool(distance < SAME_STATE_DISTANCE * radius and np.array_equal(first.sides, second.sides))


def solve_on_meshes(
    search: SharedSearch, backend: str = "auto", report: Report | None = None, near: SurfaceMap | None = None
) -> tuple[Equilibrium, list[MeshLevel]]:
    """Find an equilibrium of a sheet, from a coarse mesh to finer ones.

    Parameters
    ----------
    search : the models, and the states of an earlier search, which this one may join; if there are none, it keeps those
        of this search.
    backend, report : as in `solve_on_mesh`.
    near : surface, bumps included, from which the coarsest mesh starts at full release, with all supports in place. If
        the model has contact and the surface intersects itself, the search starts from the print.

    Returns
    -------
    The equilibrium on the last model that was needed, and the levels up to it. Iterations, factorisations and seconds
    of the equilibrium are totals over all levels.
    """
    model = search.ladder.models[0]
    start: State | None = None
    if near is not None:
        model.set_release(1.0)
        on_surface = fit_to_surface(model, near(model.mesh.points))
        start = on_surface if is_intersection_free(model, on_surface) else None
    coarsest = _solve(model, start, backend, report, search.ladder.finer_than(0))
    return solve_through_levels(search, coarsest, backend, report)


def solve_through_levels(
    search: SharedSearch, coarsest: Equilibrium, backend: str, report: Report | None
) -> tuple[Equilibrium, list[MeshLevel]]:
    """Refine an equilibrium of the first model; arguments and result as in `solve_on_meshes`."""
    ladder, is_second = search.ladder, bool(search.ends)
    ends, levels = [coarsest], [_level(ladder.models[0], coarsest)]
    while _goes_on(search, levels):
        if is_second and search.reaches(len(ends) - 1, ends[-1]):
            break
        coarse, fine = ladder.models[len(ends) - 1 : len(ends) + 1]
        clock = Clock()
        with clock("prolongation"):
            before = (ladder.models[len(ends) - 2], ends[-2].state) if len(ends) > 1 else None
            state = _prolonged(coarse, ends[-1].state, fine, before)
        is_last = ladder.tolerance_percent is None and not ladder.finer_than(len(ends))
        end = _solve(fine, state, backend, report, not is_last)
        change = change_percent(coarse, ends[-1], fine, end)
        if not is_last and not _goes_on(search, [*levels, _level(fine, end, change)]):
            # the loose end becomes an equilibrium with its certificate
            end = end.followed_by(_solve(fine, end, backend, report, False))
            change = change_percent(coarse, ends[-1], fine, end)
        ends.append(replace(end, seconds=clock.seconds | end.seconds))
        levels.append(_level(fine, ends[-1], change))
    if not is_second:
        search.ends, search.levels = list(ends), list(levels)
    elif len(ends) < len(search.ends):
        search.joined_at = levels[-1].vertices
        # finer meshes cost the second search nothing
        levels += [replace(each, iterations=0, factorisations=0, seconds={}) for each in search.levels[len(ends) :]]
        ends += [end.without_effort for end in search.ends[len(ends) :]]
    return reduce(Equilibrium.followed_by, ends), levels


def _solve(
    model: DiscreteModel, start: State | Equilibrium | None, backend: str, report: Report | None, coarse: bool
) -> Equilibrium:
    return solve_on_mesh(model, start, backend, prefixed_report(report, f"{model.n_vertices} vertices"), coarse)


def _goes_on(search: SharedSearch, levels: list[MeshLevel]) -> bool:
    """Whether another mesh follows the last one of these levels; a second search ends where the first one did."""
    number, ladder = len(levels) - 1, search.ladder
    if search.ends:
        return len(levels) < len(search.ends)
    if ladder.tolerance_percent is not None:
        error = error_of_levels(levels).percent
        least = 2 if len(ladder.layout.support_samples.printed) else LEAST_MESHES_OF_FREE_SHEETS
        if error is not None and error <= ladder.tolerance_percent and len(levels) >= least:
            return False
    return ladder.finer_than(number)


def _level(model: DiscreteModel, end: Equilibrium, change: float | None = None) -> MeshLevel:
    return MeshLevel(model.n_vertices, end.iterations, end.factorisations, end.seconds, change)


def error_of_levels(levels: Sequence[MeshLevel]) -> MeshErrorEstimate:
    """`mesh_error` of the last level."""
    return mesh_error([level.vertices for level in levels], [level.change_percent for level in levels])


def _prolonged(
    coarse: DiscreteModel, state: State, fine: DiscreteModel, before: tuple[DiscreteModel, State] | None
) -> State | None:
    """The state on the fine mesh; with the paper's hinges extrapolated from the meshes `before` and `coarse`.

    With contact, a state that would intersect itself there is None: the search starts anew.
    """
    if isinstance(fine, ContactModel):
        return _prolong_without_intersection(coarse, state, fine)
    state_on_fine = prolong(coarse, state, fine)
    if before is None or not fine.design.fabric.bending_follows_mesh:
        return state_on_fine
    # the change is proportional to the edge length; extrapolate at most as far as the last change
    edges = [1.0 / np.sqrt(m.n_vertices) for m in (before[0], coarse, fine)]
    share = min((edges[1] - edges[2]) / (edges[0] - edges[1]), 1.0)
    return extrapolate(fine, prolong(*before, fine), state_on_fine, share)


def _prolong_without_intersection(coarse: DiscreteModel, state: State, fine: ContactModel) -> State | None:
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
