"""Coarse to fine: the branch is found on about a thousand vertices, each finer mesh only corrects it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from discrete.energies.elements import Array
from discrete.evidence.creases import measure_creases
from discrete.evidence.equilibrium import Equilibrium
from discrete.model.contact_model import ContactModel, is_intersection_free
from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State
from discrete.release.contact_prolongation import prolong_without_intersection
from discrete.release.continuation import Report, prefixed_report
from discrete.release.extrapolation import extrapolate
from discrete.release.prolongation import fit_to_surface, prolong
from discrete.release.single_mesh import StartKind, solve_on_mesh
from equilibrium.newton.regularisation import Method
from pattern.design.errors import MeshError
from pattern.mesh.meshing import mesh_layout

COARSE_VERTICES = 1100
MIN_EDGES_PER_SPACING = 4.0  # edges between two stars, at least
MAX_VERTEX_RATIO = 3.0  # of vertices between two levels: soft shapes move from mesh to mesh, and far moves are slow

SurfaceMap = Callable[[Array], Array]  # printed points (n, 2) to places (n, 3) mm


@dataclass(frozen=True)
class MeshLevel:
    """What one mesh cost, and the shape found on it: `printed` (V, 2) and `positions` (V, 3) of its vertices, mm."""

    vertices: int
    iterations: int
    factorisations: int
    seconds: dict[str, float]
    printed: Array = field(repr=False)
    positions: Array = field(repr=False)

    @property
    def cost(self) -> dict[str, Any]:
        """All but the shape, for the summary."""
        names = ("vertices", "iterations", "factorisations", "seconds")
        return {name: getattr(self, name) for name in names}


def solve_on_meshes(
    model: DiscreteModel,
    start: StartKind = "bump",
    seed: int = 0,
    backend: str = "auto",
    method: Method = "blended",
    max_iterations: int = 500,
    report: Report | None = None,
    near: SurfaceMap | None = None,
) -> tuple[Equilibrium, list[MeshLevel]]:
    """Equilibrium of a model through coarser meshes of the same sheet; arguments as in `solve_on_mesh`.

    With `near` the coarsest mesh starts on that surface, bumps and all, released and held as it will be at the end; if
    there is contact and the surface passes through itself, it starts from the print. Iterations, factorisations and
    seconds of the result are those of all levels together.
    """
    models = [*coarser_models(model), model]
    tell = prefixed_report(report, f"{models[0].n_vertices} vertices") if len(models) > 1 else report
    begin: StartKind | State = start
    if near is not None:
        models[0].set_release(1.0)
        there = fit_to_surface(models[0], near(models[0].mesh.points))
        begin = there if is_intersection_free(models[0], there) else start
    found = solve_on_mesh(models[0], begin, None, seed, backend, method, max_iterations, tell)
    return solve_through_levels(models, found, start, seed, backend, method, max_iterations, report)


def solve_through_levels(
    models: Sequence[DiscreteModel],
    found: Equilibrium,
    start: StartKind,
    seed: int,
    backend: str,
    method: Method,
    max_iterations: int,
    report: Report | None,
) -> tuple[Equilibrium, list[MeshLevel]]:
    """The equilibrium of the last model, from one of the first model through those between."""
    levels = [_level(models[0], found, found.seconds)]
    path = found.path
    before: tuple[DiscreteModel, State] | None = None
    for previous, level in pairwise(models):
        begun = time.perf_counter()
        state = _carried(previous, found.state, level, start, before)
        before = previous, found.state
        prepared = time.perf_counter() - begun
        tell = prefixed_report(report, f"{level.n_vertices} vertices")
        found = solve_on_mesh(level, state, None, seed, backend, method, max_iterations, tell)
        path += found.path
        levels.append(_level(level, found, {"prolongation": prepared, **found.seconds}))
    stages: dict[str, float] = {}
    for one in levels:
        for stage, spent in one.seconds.items():
            stages[stage] = stages.get(stage, 0.0) + spent
    whole = replace(
        found,
        iterations=sum(one.iterations for one in levels),
        factorisations=sum(one.factorisations for one in levels),
        seconds=stages,
        path=path,
    )
    return whole, levels


def _level(model: DiscreteModel, found: Equilibrium, seconds: dict[str, float]) -> MeshLevel:
    work = found.iterations, found.factorisations
    return MeshLevel(model.n_vertices, *work, seconds, model.mesh.points, found.state.positions)


def _carried(
    coarse: DiscreteModel,
    state: State,
    fine: DiscreteModel,
    start: StartKind,
    before: tuple[DiscreteModel, State] | None,
) -> State | StartKind:
    """The state on a finer mesh, moved on as it did from the mesh `before`.

    Where its parts cannot be kept apart there, that mesh starts from the print.
    """
    if isinstance(fine, ContactModel):
        return prolong_without_intersection(coarse, state, fine) or start
    here = prolong(coarse, state, fine)
    if before is None or measure_creases(coarse, state).resolved:  # what moves a sheet from mesh to mesh ends there
        return here
    # an error in proportion to the edge; never further than the last move
    edges = [1.0 / np.sqrt(m.n_vertices) for m in (before[0], coarse, fine)]
    share = min((edges[1] - edges[2]) / (edges[0] - edges[1]), 1.0)
    return extrapolate(fine, prolong(*before, fine), here, share)


def coarser_models(model: DiscreteModel) -> list[DiscreteModel]:
    """Coarser models of the same design, the coarsest first; none for small ones."""
    ratio = model.n_vertices / COARSE_VERTICES
    choice = model.design.mesh
    # many stars need more vertices than that
    growth = min(np.sqrt(ratio), model.spacing / MIN_EDGES_PER_SPACING / choice.edge_mm)
    steps = int(np.ceil(2.0 * np.log(growth) / np.log(MAX_VERTEX_RATIO))) if ratio > 2.0 and growth > 1.0 else 0
    models: list[DiscreteModel] = []
    for step in range(steps, 0, -1):
        coarse_edge = choice.edge_mm * growth ** (step / steps)
        try:
            mesh = mesh_layout(model.layout, coarse_edge, choice.kind, choice.seed, choice.graded)
        except MeshError:  # arms may be too short for a coarse mesh: start on a finer one
            continue
        if len(mesh.points) < 0.6 * model.n_vertices:
            models.append(type(model)(model.design, model.layout, mesh, model.compiled))
    return models
