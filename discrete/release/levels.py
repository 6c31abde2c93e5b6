"""Coarse to fine: the branch is found on about a thousand vertices, each finer mesh only corrects it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from discrete.energies.elements import Array
from discrete.evidence.creases import creases
from discrete.evidence.equilibrium import Equilibrium
from discrete.model.contact_model import ContactModel, keeps_apart
from discrete.model.model import Model
from discrete.model.state import State
from discrete.release.contact_prolongation import prolonged_apart
from discrete.release.extrapolation import extrapolated
from discrete.release.prolongation import fitted, prolonged
from discrete.release.solve import Start, relax
from discrete.release.walk import Report, named
from equilibrium.newton.regularisation import Method
from pattern.design.errors import MeshError
from pattern.mesh.meshing import mesh_layout

COARSE_VERTICES = 1100
COARSEST = 4.0  # edges between two stars, at least
LARGEST_RATIO = 3.0  # of vertices between two levels: soft shapes move from mesh to mesh, and far moves are slow

Surface = Callable[[Array], Array]  # printed points (n, 2) to places (n, 3) mm


@dataclass(frozen=True)
class Level:
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


def find_equilibrium(
    model: Model,
    start: Start = "bump",
    seed: int = 0,
    backend: str = "auto",
    method: Method = "blended",
    max_iterations: int = 500,
    report: Report | None = None,
    near: Surface | None = None,
) -> tuple[Equilibrium, list[Level]]:
    """Equilibrium of a model through coarser meshes of the same sheet; arguments as in `relax`.

    With `near` the coarsest mesh starts on that surface, bumps and all, released and held as it will be at the end; if
    there is contact and the surface passes through itself, it starts from the print. Iterations, factorisations and
    seconds of the result are those of all levels together.
    """
    models = [*coarser(model), model]
    tell = named(report, f"{models[0].n_vertices} vertices") if len(models) > 1 else report
    begin: Start | State = start
    if near is not None:
        models[0].set_release(1.0)
        there = fitted(models[0], near(models[0].mesh.points))
        begin = there if keeps_apart(models[0], there) else start
    found = relax(models[0], begin, None, seed, backend, method, max_iterations, tell)
    return carried_up(models, found, start, seed, backend, method, max_iterations, report)


def carried_up(
    models: Sequence[Model],
    found: Equilibrium,
    start: Start,
    seed: int,
    backend: str,
    method: Method,
    max_iterations: int,
    report: Report | None,
) -> tuple[Equilibrium, list[Level]]:
    """The equilibrium of the last model, from one of the first model through those between."""
    levels = [_level(models[0], found, found.seconds)]
    path = found.path
    before: tuple[Model, State] | None = None
    for previous, level in pairwise(models):
        begun = time.perf_counter()
        state = _carried(previous, found.state, level, start, before)
        before = previous, found.state
        prepared = time.perf_counter() - begun
        tell = named(report, f"{level.n_vertices} vertices")
        found = relax(level, state, None, seed, backend, method, max_iterations, tell)
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


def _level(model: Model, found: Equilibrium, seconds: dict[str, float]) -> Level:
    work = found.iterations, found.factorisations
    return Level(model.n_vertices, *work, seconds, model.mesh.points, found.state.positions)


def _carried(
    coarse: Model, state: State, fine: Model, start: Start, before: tuple[Model, State] | None
) -> State | Start:
    """The state on a finer mesh, moved on as it did from the mesh `before`.

    Where its parts cannot be kept apart there, that mesh starts from the print.
    """
    if isinstance(fine, ContactModel):
        return prolonged_apart(coarse, state, fine) or start
    here = prolonged(coarse, state, fine)
    if before is None or creases(coarse, state).resolved:  # what moves a sheet from mesh to mesh ends there
        return here
    # an error in proportion to the edge; never further than the last move
    edges = [1.0 / np.sqrt(m.n_vertices) for m in (before[0], coarse, fine)]
    share = min((edges[1] - edges[2]) / (edges[0] - edges[1]), 1.0)
    return extrapolated(fine, prolonged(*before, fine), here, share)


def coarser(model: Model) -> list[Model]:
    """Coarser models of the same design, the coarsest first; none for small ones."""
    ratio = model.n_vertices / COARSE_VERTICES
    choice = model.design.mesh
    # many stars need more vertices than that
    growth = min(np.sqrt(ratio), model.spacing / COARSEST / choice.edge_mm)
    steps = int(np.ceil(2.0 * np.log(growth) / np.log(LARGEST_RATIO))) if ratio > 2.0 and growth > 1.0 else 0
    models: list[Model] = []
    for step in range(steps, 0, -1):
        coarse_edge = choice.edge_mm * growth ** (step / steps)
        try:
            mesh = mesh_layout(model.layout, coarse_edge, choice.kind, choice.seed, choice.graded)
        except MeshError:  # arms may be too short for a coarse mesh: start on a finer one
            continue
        if len(mesh.points) < 0.6 * model.n_vertices:
            models.append(type(model)(model.design, model.layout, mesh, model.compiled))
    return models
