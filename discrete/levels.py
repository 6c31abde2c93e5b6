"""Coarse to fine: the branch is found on about a thousand vertices, each finer mesh only corrects it."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from discrete.contact_model import ContactModel
from discrete.contact_prolongation import prolonged_apart
from discrete.model import Model
from discrete.prolongation import prolonged
from discrete.solve import Equilibrium, Report, Start, relax
from discrete.state import State
from equilibrium.newton import Iteration, Method
from pattern.errors import MeshError
from pattern.meshing import mesh_layout

COARSE_VERTICES = 1100
LARGEST_RATIO = 12.0  # of vertices between two levels


@dataclass(frozen=True)
class Level:
    """What one mesh cost."""

    vertices: int
    iterations: int
    factorisations: int
    seconds: dict[str, float]


def find_equilibrium(
    model: Model,
    start: Start = "bump",
    seed: int = 0,
    backend: str = "auto",
    method: Method = "blended",
    max_iterations: int = 500,
    report: Report | None = None,
) -> tuple[Equilibrium, list[Level]]:
    """Equilibrium of a model through coarser meshes of the same sheet; arguments as in `relax`.

    Iterations, factorisations and seconds of the result are those of all levels together.
    """
    found: Equilibrium | None = None
    previous: Model | None = None
    levels: list[Level] = []
    for level in [*_coarser(model), model]:
        begun = time.perf_counter()
        if previous is None or found is None:
            state: Start | State = start
        else:
            state = _carried(previous, found.state, level, start)
        prepared = time.perf_counter() - begun
        name = f"{level.n_vertices} vertices"
        found = relax(
            level,
            state,
            seed=seed,
            backend=backend,
            method=method,
            max_iterations=max_iterations,
            report=_named(report, name if level is not model or previous is not None else ""),
        )
        seconds = {"prolongation": prepared, **found.seconds} if previous is not None else found.seconds
        levels.append(Level(level.n_vertices, found.iterations, found.factorisations, seconds))
        previous = level
    assert found is not None
    stages: dict[str, float] = {}
    for one in levels:
        for stage, spent in one.seconds.items():
            stages[stage] = stages.get(stage, 0.0) + spent
    whole = replace(
        found,
        iterations=sum(one.iterations for one in levels),
        factorisations=sum(one.factorisations for one in levels),
        seconds=stages,
    )
    return whole, levels


def _carried(coarse: Model, state: State, fine: Model, start: Start) -> State | Start:
    """The state on a finer mesh; where its parts cannot be kept apart there, that mesh starts from the print."""
    if isinstance(fine, ContactModel):
        return prolonged_apart(coarse, state, fine) or start
    return prolonged(coarse, state, fine)


def _coarser(model: Model) -> list[Model]:
    """Coarser models of the same design, the coarsest first; none for small ones."""
    ratio = model.n_vertices / COARSE_VERTICES
    steps = int(np.ceil(np.log(ratio) / np.log(LARGEST_RATIO))) if ratio > 2.0 else 0
    edge = model.design.mesh.edge_mm
    models: list[Model] = []
    for step in range(steps, 0, -1):
        coarse_edge = min(edge * np.sqrt(ratio) ** (step / steps), model.spacing / 4.0)
        try:
            mesh = mesh_layout(model.layout, coarse_edge, model.design.mesh.kind, model.design.mesh.seed)
        except MeshError:  # arms may be too short for a coarse mesh: start on a finer one
            continue
        if len(mesh.points) < 0.6 * model.n_vertices:
            models.append(type(model)(model.design, model.layout, mesh, model.compiled))
    return models


def _named(report: Report | None, level: str) -> Report | None:
    if report is None or not level:
        return report

    def tell(stage: str, iteration: Iteration) -> None:
        report(f"{level}, {stage}", iteration)

    return tell
