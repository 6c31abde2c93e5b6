"""Search from coarse to fine: a mesh of about 1100 vertices finds the form, and each finer mesh corrects it.

Soft sheets change from mesh to mesh, mostly in the same direction. Extrapolation of the states on two meshes saves
iterations on the next finer mesh.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from asterism.discrete.evidence.creases import measure_creases
from asterism.discrete.evidence.equilibrium import Equilibrium
from asterism.discrete.model.contact_model import ContactModel, is_intersection_free
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State, edge_tangents, rotate_vectors
from asterism.discrete.release.continuation import Report, prefixed_report
from asterism.discrete.release.prolongation import fit_to_surface, plastic_normals, prolong, prolong_linearly
from asterism.discrete.release.shared_search import MeshLevel, SharedSearch
from asterism.discrete.release.single_mesh import StartKind, solve_on_mesh
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.mesh.meshing import mesh_layout

COARSE_VERTICES = 1100  # vertices of the coarsest mesh, about; more if the design has many stars
MIN_EDGES_PER_SPACING = 4.0  # edges between two adjacent stars of the coarsest mesh
MAX_VERTEX_RATIO = 3.0  # 1: vertices of a level over those of the level before; large changes of a soft shape are slow
MAX_COARSE_VERTEX_FRACTION = 0.6  # 1: vertices of a coarse mesh over those of the finest, if it is worth its time
SurfaceMap = Callable[[Array], Array]  # printed points (n, 2) mm to points in space (n, 3) mm


def solve_on_meshes(
    model: DiscreteModel,
    start: StartKind = "bump",
    seed: int = 0,
    backend: str = "auto",
    report: Report | None = None,
    near: SurfaceMap | None = None,
    coarser: bool = True,
    shared: SharedSearch | None = None,
) -> tuple[Equilibrium, list[MeshLevel]]:
    """Find an equilibrium of a model through coarser meshes of the same sheet.

    Parameters
    ----------
    model, start, seed, backend, report : as in `solve_on_mesh`.
    near : surface, bumps included, from which the coarsest mesh starts at full release, with all supports in place. If
        the model has contact and the surface intersects itself, the search starts from the print.
    coarser : search on coarser meshes first. A surface that is nearly an equilibrium of the fine mesh does without.
    shared : models and states of an earlier search of the same model; a new object keeps those of this search.

    Returns
    -------
    The equilibrium on the mesh of the model, and the levels from coarse to fine. Iterations, factorisations and seconds
    of the equilibrium are totals over all levels.
    """
    search = shared or SharedSearch()
    if not search.models:
        search.models = [*(coarser_models(model) if coarser else ()), model]
    models = search.models
    level_report = prefixed_report(report, f"{models[0].n_vertices} vertices") if len(models) > 1 else report
    first: StartKind | State = start
    if near is not None:
        models[0].set_release(1.0)
        on_surface = fit_to_surface(models[0], near(models[0].mesh.points))
        first = on_surface if is_intersection_free(models[0], on_surface) else start
    coarse = len(models) > 1
    coarsest = solve_on_mesh(models[0], first, seed, backend, level_report, coarse)
    return solve_through_levels(models, coarsest, start, seed, backend, report, search)


def solve_through_levels(
    models: Sequence[DiscreteModel],
    coarsest: Equilibrium,
    start: StartKind,
    seed: int,
    backend: str,
    report: Report | None,
    search: SharedSearch | None = None,
) -> tuple[Equilibrium, list[MeshLevel]]:
    """Prolong an equilibrium of the first model through all models; arguments and result as in `solve_on_meshes`.

    Parameters
    ----------
    models : from coarse to fine.
    coarsest : equilibrium of the first model.
    search : an earlier search on these models, which this one may join; an empty one keeps the states of this search.
    """
    search = search or SharedSearch()
    is_second = search.is_complete
    equilibrium = coarsest
    ends = [equilibrium]
    levels = [_level(models[0], equilibrium, equilibrium.seconds)]
    path = equilibrium.path
    before: tuple[DiscreteModel, State] | None = None
    for number, (coarse, fine) in enumerate(pairwise(models)):
        if is_second and search.reaches(number, equilibrium):
            break
        begun = time.perf_counter()
        state = _prolonged(coarse, equilibrium.state, fine, start, before)
        before = coarse, equilibrium.state
        prepared = time.perf_counter() - begun
        level_report = prefixed_report(report, f"{fine.n_vertices} vertices")
        last = fine is models[-1]
        equilibrium = solve_on_mesh(fine, state, seed, backend, level_report, not last)
        path += equilibrium.path
        ends.append(equilibrium)
        levels.append(_level(fine, equilibrium, {"prolongation": prepared, **equilibrium.seconds}))
    if not is_second:
        search.ends, search.levels = ends, levels
    elif len(ends) < len(models):
        equilibrium, levels, path = search.joined(levels, path)
    stages: dict[str, float] = {}
    for level in levels:
        for stage, spent in level.seconds.items():
            stages[stage] = stages.get(stage, 0.0) + spent
    total = replace(
        equilibrium,
        iterations=sum(level.iterations for level in levels),
        factorisations=sum(level.factorisations for level in levels),
        seconds=stages,
        path=path,
    )
    return total, levels


def _level(model: DiscreteModel, equilibrium: Equilibrium, seconds: dict[str, float]) -> MeshLevel:
    work = equilibrium.iterations, equilibrium.factorisations
    return MeshLevel(model.n_vertices, *work, seconds, model.mesh.points, equilibrium.state.positions)


def _prolonged(
    coarse: DiscreteModel,
    state: State,
    fine: DiscreteModel,
    start: StartKind,
    before: tuple[DiscreteModel, State] | None,
) -> State | StartKind:
    """The state on the fine mesh, extrapolated from the meshes `before` and `coarse` while creases are not resolved.

    With contact, a state that would intersect itself on the fine mesh is replaced by the start.
    """
    if isinstance(fine, ContactModel):
        return _prolong_without_intersection(coarse, state, fine) or start
    state_on_fine = prolong(coarse, state, fine)
    if before is None or measure_creases(coarse, state).resolved:  # from here on shapes change little between meshes
        return state_on_fine
    # the mesh error is proportional to the edge length; extrapolate at most as far as the last change
    edges = [1.0 / np.sqrt(m.n_vertices) for m in (before[0], coarse, fine)]
    share = min((edges[1] - edges[2]) / (edges[0] - edges[1]), 1.0)
    return extrapolate(fine, prolong(*before, fine), state_on_fine, share)


def coarser_models(model: DiscreteModel) -> list[DiscreteModel]:
    """Models of the same design on coarser meshes, the coarsest first; empty for a small model.

    Examples
    --------
    >>> from asterism.pattern import gallery
    >>> from asterism.pattern.layout.build import layout
    >>> design = gallery.load("star")
    >>> plan = layout(design)
    >>> coarser_models(DiscreteModel(design, plan, mesh_layout(plan, 4.0)))
    []
    """
    ratio = model.n_vertices / COARSE_VERTICES
    section = model.design.mesh
    # designs of many stars need more than COARSE_VERTICES
    growth = min(np.sqrt(ratio), model.spacing / MIN_EDGES_PER_SPACING / section.edge_mm)
    steps = int(np.ceil(2.0 * np.log(growth) / np.log(MAX_VERTEX_RATIO))) if ratio > 2.0 and growth > 1.0 else 0
    models: list[DiscreteModel] = []
    for step in range(steps, 0, -1):
        coarse_edge = section.edge_mm * growth ** (step / steps)
        try:
            mesh = mesh_layout(model.layout, coarse_edge, section.kind, section.seed, section.graded)
        except MeshError:  # arms too short for this mesh: the search starts on a finer one
            continue
        if len(mesh.points) < MAX_COARSE_VERTEX_FRACTION * model.n_vertices:
            models.append(type(model)(model.design, model.layout, mesh))
    return models


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


def extrapolate(model: DiscreteModel, before: State, state: State, share: float) -> State:
    """Extrapolate from the state `before` beyond `state`, both on the mesh of the model.

    Every triangle and rod edge rotates on about the axis of its rotation between the two states, without stretch, as in
    a sheet that rolls up to a tube. Positions follow by least squares.

    Parameters
    ----------
    share : rotation beyond `state` over the rotation from `before` to `state`.
    """
    rotation, shift = rigid_fit(before.positions, state.positions)
    old = before.rotated(rotation, shift)
    (f0, _), (f1, e1) = (model.reconstruction.gradients(s.positions) for s in (old, state))
    spin = share * rotation_vectors(_spatial(f0), _spatial(f1))
    edge_spin = share * rotation_vectors(*(_frames(model, s) for s in (old, state)))
    columns = f1.transpose(0, 2, 1)
    change = (rotate_vectors(spin, columns) - columns).transpose(0, 2, 1)
    edge_change = rotate_vectors(edge_spin, e1[:, None])[:, 0] - e1
    positions = state.positions + model.reconstruction.displacements(change, edge_change)
    return model.with_fitted_frames(State(positions, plastic_normals(model, positions)))


def rotation_vectors(before: Array, after: Array) -> Array:
    """(E, 3) rad, vectors of the rotations in the polar decompositions of `after before^-1`, matrices (E, 3, 3).

    Examples
    --------
    >>> quarter = np.array([[[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]])
    >>> (rotation_vectors(np.eye(3)[None], quarter) / np.pi).round(6) + 0.0
    array([[0. , 0. , 0.5]])
    """
    u, _, vt = np.linalg.svd(after @ np.linalg.inv(before))
    q = u @ vt
    skew = np.stack([q[:, 2, 1] - q[:, 1, 2], q[:, 0, 2] - q[:, 2, 0], q[:, 1, 0] - q[:, 0, 1]], axis=1)
    sine = 0.5 * np.linalg.norm(skew, axis=1)
    angle = np.arctan2(sine, 0.5 * (np.trace(q, axis1=1, axis2=2) - 1.0))
    # a rotation by pi has no axis in this formula and gives zero; no element rotates so far between two meshes
    return np.asarray((0.5 * angle / np.maximum(sine, 1e-12))[:, None] * skew)


def _spatial(f: Array) -> Array:
    """(T, 3, 3) deformation gradients (T, 3, 2) with the unit normal as third column."""
    normal = np.cross(f[:, :, 0], f[:, :, 1])
    return np.concatenate([f, (normal / np.linalg.norm(normal, axis=1, keepdims=True))[:, :, None]], axis=2)


def _frames(model: DiscreteModel, state: State) -> Array:
    """(R, 3, 3) tangent, director and their cross product of every rod edge, as columns."""
    t = edge_tangents(state.positions, model.edges)
    return np.stack([t, state.directors, np.cross(t, state.directors)], axis=2)
