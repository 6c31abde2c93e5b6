"""Search from coarse to fine: the coarsest mesh finds the form, and each finer mesh corrects it.

The search ends on the first mesh on which the estimated error of the shape is within the tolerance of the design, or on
the mesh of the edge that the design gives.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from asterism.discrete.evidence.equilibrium import Equilibrium
from asterism.discrete.model.contact_model import ContactModel, is_intersection_free
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.continuation import Report, prefixed_report
from asterism.discrete.release.extrapolation import extrapolate
from asterism.discrete.release.ladder import Ladder
from asterism.discrete.release.mesh_error import change_percent, error_of_levels
from asterism.discrete.release.prolongation import fit_to_surface, prolong, prolong_linearly
from asterism.discrete.release.shared_search import MeshLevel, SharedSearch
from asterism.discrete.release.single_mesh import StartKind, solve_on_mesh
from asterism.equilibrium.arrays import Array

SurfaceMap = Callable[[Array], Array]  # printed points (n, 2) mm to points in space (n, 3) mm
# to a tolerance: the softest modes of a sheet without supports hardly change between the two coarsest ones
LEAST_MESHES_OF_FREE_SHEETS = 3


def solve_on_meshes(
    search: SharedSearch,
    start: StartKind = "bump",
    seed: int = 0,
    backend: str = "auto",
    report: Report | None = None,
    near: SurfaceMap | None = None,
) -> tuple[Equilibrium, list[MeshLevel]]:
    """Find an equilibrium of a sheet, from a coarse mesh to finer ones.

    Parameters
    ----------
    search : the models, and the states of an earlier search, which this one may join; if there are none, it keeps those
        of this search.
    start, seed, backend, report : as in `solve_on_mesh`.
    near : surface, bumps included, from which the coarsest mesh starts at full release, with all supports in place. If
        the model has contact and the surface intersects itself, the search starts from the print.

    Returns
    -------
    The equilibrium on the last model that was needed, and the levels up to it. Iterations, factorisations and seconds
    of the equilibrium are totals over all levels.
    """
    model = search.ladder.models[0]
    first: StartKind | State = start
    if near is not None:
        model.set_release(1.0)
        on_surface = fit_to_surface(model, near(model.mesh.points))
        first = on_surface if is_intersection_free(model, on_surface) else start
    coarse = search.ladder.finer_than(0)
    coarsest = solve_on_mesh(model, first, seed, backend, _named(report, model) if coarse else report, coarse)
    return solve_through_levels(search, coarsest, start, seed, backend, report)


def solve_through_levels(
    search: SharedSearch, coarsest: Equilibrium, start: StartKind, seed: int, backend: str, report: Report | None
) -> tuple[Equilibrium, list[MeshLevel]]:
    """Refine an equilibrium of the first model; arguments and result as in `solve_on_meshes`."""
    ladder, is_second = search.ladder, bool(search.ends)
    ends = [coarsest]
    levels = [_level(ladder.models[0], coarsest, coarsest.seconds)]
    path = coarsest.path
    while _goes_on(search, levels):
        if is_second and search.reaches(len(ends) - 1, ends[-1]):
            break
        model, fine = ladder.models[len(ends) - 1 : len(ends) + 1]
        begun = time.perf_counter()
        before = (ladder.models[len(ends) - 2], ends[-2].state) if len(ends) > 1 else None
        state = _prolonged(model, ends[-1].state, fine, start, before)
        prepared = time.perf_counter() - begun
        last = ladder.tolerance_percent is None and not ladder.finer_than(len(ends))
        equilibrium = solve_on_mesh(fine, state, seed, backend, _named(report, fine), not last)
        path += equilibrium.path
        change = change_percent(model, ends[-1], fine, equilibrium)
        ends.append(equilibrium)
        levels.append(_level(fine, equilibrium, {"prolongation": prepared, **equilibrium.seconds}, change))
        if not last and not _goes_on(search, levels):
            ends[-1], levels[-1] = _certified(ladder, ends, levels, seed, backend, report)
            path += ends[-1].path
    if not is_second:
        search.ends, search.levels = ends, levels
    elif len(ends) < len(search.ends):
        ends[-1], levels, path = search.joined(levels, path)
    total = replace(
        ends[-1],
        iterations=sum(level.iterations for level in levels),
        factorisations=sum(level.factorisations for level in levels),
        seconds=_added(*(level.seconds for level in levels)),
        path=path,
    )
    return total, levels


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


def _certified(
    ladder: Ladder, ends: list[Equilibrium], levels: list[MeshLevel], seed: int, backend: str, report: Report | None
) -> tuple[Equilibrium, MeshLevel]:
    """The last end minimised to the tolerance of an equilibrium, with its certificate, and its level."""
    number, loose, level = len(ends) - 1, ends[-1], levels[-1]
    model = ladder.models[number]
    end = solve_on_mesh(model, loose.state, seed, backend, _named(report, model))
    return end, replace(
        level,
        iterations=level.iterations + end.iterations,
        factorisations=level.factorisations + end.factorisations,
        seconds=_added(level.seconds, end.seconds),
        change_percent=change_percent(ladder.models[number - 1], ends[-2], model, end),
    )


def _added(*each: dict[str, float]) -> dict[str, float]:
    """The sums of seconds by stage."""
    total: dict[str, float] = {}
    for seconds in each:
        for stage, spent in seconds.items():
            total[stage] = total.get(stage, 0.0) + spent
    return total


def _named(report: Report | None, model: DiscreteModel) -> Report | None:
    return prefixed_report(report, f"{model.n_vertices} vertices")


def _level(model: DiscreteModel, end: Equilibrium, seconds: dict[str, float], change: float | None = None) -> MeshLevel:
    return MeshLevel(model.n_vertices, end.iterations, end.factorisations, seconds, change)


def _prolonged(
    coarse: DiscreteModel,
    state: State,
    fine: DiscreteModel,
    start: StartKind,
    before: tuple[DiscreteModel, State] | None,
) -> State | StartKind:
    """The state on the fine mesh; with the paper's hinges extrapolated from the meshes `before` and `coarse`.

    With contact, a state that would intersect itself there is replaced by the start.
    """
    if isinstance(fine, ContactModel):
        return _prolong_without_intersection(coarse, state, fine) or start
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
