"""Search from coarse to fine: the coarsest mesh finds the form, and each finer mesh corrects it.

The search ends on the first mesh on which the estimated error of the shape is within the tolerance of the design, or on
the mesh of the edge that the design gives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import reduce
from math import sqrt

import numpy as np

from asterism.discrete.model.contact_model import ContactModel, is_intersection_free
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.continuation import Report, prefixed_report, solve_on_mesh
from asterism.discrete.release.equilibrium import Equilibrium
from asterism.discrete.release.mesh_error import MeshErrorEstimate, change_percent, mesh_error
from asterism.discrete.release.prolongation import extrapolate, fit_to_surface, prolong, prolong_linearly
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.clock import Clock
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.meshing import mesh_layout

# 1: edges of a mesh over those of the next finer one
EDGE_RATIO = sqrt(2.0)
# a search to a tolerance makes no mesh of more vertices, but for a second one
MAX_VERTICES = 25_000
# the shortest edge of a design
MIN_EDGE_MM = 0.2
# a search to a given edge: vertices of the coarsest mesh, about
COARSE_VERTICES = 1100


def model_on(design: Design, layout: Layout, edge_mm: float) -> DiscreteModel:
    """The model of a design on one mesh; with contact if the design asks for it.

    Raises `MeshError` if no mesh of this edge follows the rods.
    """
    mesh = mesh_layout(layout, edge_mm, design.mesh.kind, design.mesh.seed, design.graded_meshes)
    return (ContactModel if design.solver.contact else DiscreteModel)(design, layout, mesh)


class Ladder:
    """The models of a sheet from coarse to fine.

    With a tolerance there is always a finer one, up to `MAX_VERTICES`; the search ends where its estimated error is
    within the tolerance. With a given edge the last mesh has this edge.

    Parameters
    ----------
    design, layout : the sheet.
    edge_mm : edge of a single mesh; by default the search has coarser ones, as the design says.

    >>> from asterism.pattern import gallery
    >>> from asterism.pattern.layout.build import layout
    >>> design = gallery.load("star")
    >>> [model.n_vertices for model in Ladder(design, layout(design), edge_mm=4.0).models]
    [37]
    """

    def __init__(self, design: Design, layout: Layout, edge_mm: float | None = None) -> None:
        self.design, self.layout, self._single = design, layout, edge_mm
        # of the diameter; None if the edge is given
        self.tolerance_percent = None if edge_mm or design.mesh_edge_mm else design.mesh.tolerance_percent
        self._models: list[DiscreteModel] = []
        self._edges: list[float] = []
        self._next = 0.0

    @property
    def models(self) -> list[DiscreteModel]:
        """From coarse to fine, those made so far; the first use makes the coarsest one, or all if the edge is given."""
        if not self._models:
            given = self._single or self.design.mesh_edge_mm
            if given is None:
                self._next = self._coarsest_edge()
                self._add_finer()
            else:
                self._add_down_to(given)
        return self._models

    @property
    def edges(self) -> list[float]:
        """mm, of the meshes of the models."""
        return self._edges if self.models else []

    def finer_than(self, number: int) -> bool:
        """Whether there is a model after the one of this number; with a tolerance it is made now."""
        if number + 1 < len(self.models):
            return True
        if self.tolerance_percent is None:
            return False
        enough = EDGE_RATIO**2 * self.models[-1].n_vertices > MAX_VERTICES or self._next < self._finest_edge()
        return not (enough and number > 0) and self._add_finer()

    def _coarsest_edge(self) -> float:
        """The edge of the coarsest mesh, mm."""
        # 5 edges between two adjacent stars, and 300 vertices of a small sheet
        of_small_sheet = sqrt(abs(polygon_area(self.layout.outline)) / (sqrt(0.75) * 300))
        return float(max(min(self.layout.spacing_mm / 5, of_small_sheet), MIN_EDGE_MM))

    def _finest_edge(self) -> float:
        """The edge of the finest mesh, mm: errors are about proportional to the edge to the power of 3/2."""
        assert self.tolerance_percent is not None, "the search is to a tolerance"
        # 14.5 edges between two adjacent stars, for a tolerance of 1 % and more: all but the softest sheets are within
        # it on coarser meshes
        return float(self.layout.spacing_mm / 14.5 * min(self.tolerance_percent, 1.0) ** (2.0 / 3.0))

    def _add_finer(self) -> bool:
        """Add the next finer model; a mesh whose edges are too long for the rods is passed over."""
        problem: MeshError | None = None
        # edges may be too long for the rods
        for _ in range(6):
            if self._next < MIN_EDGE_MM:
                break
            edge, self._next = self._next, self._next / EDGE_RATIO
            try:
                self._add(edge)
                return True
            except MeshError as error:
                problem = error
        if problem is not None and not self._models:
            raise problem
        return False

    def _add_down_to(self, edge: float) -> None:
        finest = model_on(self.design, self.layout, edge)
        for coarse in () if self._single else coarser_edges(finest, edge):
            # a coarse mesh with more vertices is not worth its time
            with suppress(MeshError):  # arms too short for this mesh: the search starts on a finer one
                self._add(coarse, 0.6 * finest.n_vertices)
        self._models.append(finest)
        self._edges.append(edge)

    def _add(self, edge: float, most: float = np.inf) -> None:
        model = model_on(self.design, self.layout, edge)
        if model.n_vertices < most:
            self._models.append(model)
            self._edges.append(edge)


def coarser_edges(finest: DiscreteModel, edge_mm: float) -> list[float]:
    """mm, edges of the coarser meshes of a search that ends on a given mesh, the longest first."""
    ratio = finest.n_vertices / COARSE_VERTICES
    # designs of many stars need more than COARSE_VERTICES: 4 edges between two adjacent stars
    growth = min(np.sqrt(ratio), finest.spacing / 4.0 / edge_mm)
    # a level has at most three times the vertices of the one before: large changes of a soft shape are slow
    steps = int(np.ceil(2.0 * np.log(growth) / np.log(3.0))) if ratio > 2.0 and growth > 1.0 else 0
    return [edge_mm * growth ** (step / steps) for step in range(steps, 0, -1)]


SurfaceMap = Callable[[Array], Array]  # printed points (n, 2) mm to points in space (n, 3) mm


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
    if abs(first.energy - second.energy) > 1e-8 * elastic:
        return False
    one, other = first.state.positions, second.state.positions
    rotation, shift = rigid_fit(other, one)
    distance = np.linalg.norm(other @ rotation.T + shift - one)
    radius = np.linalg.norm(one - one.mean(axis=0))
    return bool(distance < 1e-4 * radius and np.array_equal(first.sides, second.sides))


def solve_on_meshes(
    search: SharedSearch, backend: str = "auto", report: Report | None = None, near: SurfaceMap | None = None
) -> tuple[Equilibrium, list[MeshLevel]]:
    """Find an equilibrium of a sheet, from a coarse mesh to finer ones.

    The result is the equilibrium on the last model that was needed, with the effort on all levels, and these levels.

    Parameters
    ----------
    search : the models, and the states of an earlier search, which this one may join; if there are none, it keeps those
        of this search.
    backend, report : as in `solve_on_mesh`.
    near : surface, bumps included, from which the coarsest mesh starts at full release, with all supports in place. If
        the model has contact and the surface intersects itself, the search starts from the print.
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
        # the softest modes of a sheet without supports hardly change between the two coarsest meshes
        least = 2 if len(ladder.layout.support_samples.printed) else 3
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
