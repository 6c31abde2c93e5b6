"""The exact model of a design on a mesh, at any release between the stretched print and the released sheet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from scipy.spatial import cKDTree

from asterism.discrete.energies.bending.fabric_bending import BendingMesh, bending_of
from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.membrane import Membrane, SideMembrane, flat_share
from asterism.discrete.energies.rods.joint import RodJoint
from asterism.discrete.energies.rods.network import (
    JointNetwork,
    RodNetwork,
    bend_params,
    fitted_frames,
    joint_inputs,
    joint_network,
    joint_params,
    rod_network,
    stencil_inputs,
    stretch_params,
    twist_params,
)
from asterism.discrete.energies.rods.rod import RodBend, RodStretch, RodTwist
from asterism.discrete.model.reconstruction import Reconstruction
from asterism.discrete.model.state import State, moved_state
from asterism.discrete.model.system import System
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric, residual_curvature, rest_curvature, rest_twist
from asterism.pattern.design.stars import ROD_SIZES
from asterism.pattern.geometry.normals import vertex_normals
from asterism.pattern.geometry.planar import triangle_areas
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.rods.graph import RodGraph


@dataclass(frozen=True)
class Constraints:
    """Held components of vertices and their prescribed motion."""

    held: Array  # (V, 3) bool
    # (V, 3) mm, positions before the release; for pins that act after it, positions at which they take hold.
    printed: Array
    target: Array  # (V, 3) mm, positions of the held components at the end

    def positions_at(self, progress: float) -> Array:
        """(V, 3) mm, positions of held components at a progress from 0 (printed) to 1 (target), on a straight line."""
        return self.printed + progress * (self.target - self.printed)

    @property
    def mean_support(self) -> Array:
        """(3,) mm, mean target of the held components along x, y and z; 0 along an axis without supports."""
        total = np.where(self.held, self.target, 0.0).sum(axis=0)
        return np.asarray(total / np.maximum(self.held.sum(axis=0), 1))


def pin_constraints(layout: Layout, mesh: Mesh) -> Constraints:
    """The supports of a layout on the vertices of its mesh."""
    printed = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    held = np.zeros(printed.shape, dtype=bool)
    target = printed.copy()
    for pin, vertices in zip(layout.pins, mesh.pin_vertices, strict=True):
        fixed = np.asarray(pin.fixed)
        places = pin.places(mesh.points[vertices])
        held[vertices] |= fixed
        target[vertices] = np.where(fixed, places, target[vertices])
    return Constraints(held, printed, target)


class DiscreteModel(System):
    """Elastic rods on a shell: all energies of a design, with its supports and its weight.

    Parameters
    ----------
    design : the design.
    layout : its stars, outline and supports, from `pattern.layout.build.layout`.
    mesh : mesh of the layout, from `pattern.mesh.meshing.mesh_layout`.
    bending_mesh : the same mesh with what lies beyond its border, if it is periodic.

    `parts` has membrane, membrane_sides with a plate, those of `bending`, rod_bending, rod_stretch, rod_twist, and
    rod_joints if there are joints.

    One star, as printed and not yet released: the fabric holds all the energy.

    >>> from asterism.pattern import gallery
    >>> from asterism.pattern.layout.build import layout
    >>> from asterism.pattern.mesh.meshing import mesh_layout
    >>> design = gallery.load("star")
    >>> plan = layout(design)
    >>> model = DiscreteModel(design, plan, mesh_layout(plan, 4.0))
    >>> sorted(model.parts)
    ['folds', 'membrane', 'membrane_sides', 'plate', 'rod_bending', 'rod_stretch', 'rod_twist']
    >>> energies = model.energies(model.printed_state())
    >>> energies["membrane"] > 10 * energies["rod_bending"] > 0 and abs(energies["rod_stretch"]) < 1e-12
    True
    """

    def __init__(self, design: Design, layout: Layout, mesh: Mesh, bending_mesh: BendingMesh | None = None) -> None:
        self.design, self.layout, self.mesh = design, layout, mesh
        self.bending = bending_of(design.fabric)
        self.network, self.joints = _networks(layout.graph, mesh)
        # (R, K) `pattern.design.stars.ROD_SIZES` at the midpoint of every rod edge
        self.edge_sections = _sections_at_midpoints(self.network, layout.graph)
        self.edge_thickness, self.edge_width = self.edge_sections[:, 0], self.edge_sections[:, 1]
        self.edge_side = layout.rod_side[self.network.rod]
        self._own_residual_curvature = self._residual_curvature_over_the_plastics()
        self.constraints = pin_constraints(layout, mesh)
        edges = self.network.edges
        n_turns = len(edges) + 3 * len(self.joints.vertices)
        held = np.concatenate([self.constraints.held.ravel(), np.zeros(n_turns, dtype=bool)])
        parts = fabric_energies(design.fabric, bending_mesh or BendingMesh(mesh.triangles, mesh.points)) | self._rods()
        super().__init__(parts, len(mesh.points), edges, held, joint_vertices=self.joints.vertices)
        self.load_datum = self.constraints.mean_support
        self._weight = self._dead_load()
        self.set_release(1.0)
        self._reconstruction: Reconstruction | None = None

    def _rods(self) -> dict[str, Elements]:
        net, points, plastic = self.network, self.mesh.points, self.design.plastic
        modulus = self.design.fabric.modulus * plastic.modulus_ratio
        h, w = self.edge_thickness, self.edge_width
        inputs, dofs = stencil_inputs(net, len(points))
        edge_dofs = (3 * net.edges[:, :, None] + np.arange(3)).reshape(-1, 6)
        # set_release sets the rest curvature
        no_rest = np.zeros(len(h))
        parts: dict[str, Elements] = {
            "rod_bending": RodBend(inputs, dofs, bend_params(net, points, modulus, w, h, no_rest)),
            "rod_stretch": RodStretch(edge_dofs, edge_dofs, stretch_params(net, points, modulus, w, h)),
            "rod_twist": RodTwist(inputs, dofs, twist_params(net, points, modulus, plastic.poisson, w, h)),
        }
        if len(self.joints.vertices):
            params = joint_params(self.joints, points, modulus, plastic.poisson, w, h, no_rest)
            parts["rod_joints"] = RodJoint(*joint_inputs(self.joints, len(points), len(net.edges)), params)
        return parts

    def _residual_curvature_over_the_plastics(self) -> Array:
        """(R,) 1/mm, residual curvature of every rod edge minus that of the design's plastic; 0 where they are one."""
        of_rods = [rod.kappa_bar for rod in self.layout.graph.rods]
        plastic = residual_curvature(self.edge_thickness, self.design.plastic.kappa_bar_per_mm)
        of_edge = np.array([np.nan if value is None else value for value in of_rods])[self.network.rod]
        return np.where(np.isnan(of_edge), 0.0, of_edge - plastic)

    def _dead_load(self) -> Array:
        """(3 V,) N, weight of fabric and plastic, lumped to the vertices; zero without gravity."""
        gravity, fabric, plastic = self.design.gravity, self.design.fabric, self.design.plastic
        if not gravity.on:
            return np.zeros(3 * self.n_vertices)
        length = self.parts["rod_stretch"].params[:, 1]
        sheet = fabric.printed_mass * triangle_areas(self.mesh.points, self.mesh.triangles) / 3.0
        # kg/m^3 times mm^3 = 1e-9 kg
        rod = 1e-9 * plastic.density_kg_m3 * self.edge_thickness * self.edge_width * length / 2.0
        mass = np.zeros(self.n_vertices)
        np.add.at(mass, self.mesh.triangles, sheet[:, None])
        np.add.at(mass, self.network.edges, rod[:, None])
        direction = np.asarray(gravity.direction, dtype=float)
        pull = gravity.acceleration_m_s2 * direction / np.linalg.norm(direction)
        return (mass[:, None] * pull).ravel()

    def set_release(self, release: float) -> None:
        """Set the rest shape for a release from 0 (stretched print) to 1 (the design's stretch is released).

        The rest curvature and twist of the arms, the positions of the pins and the weight follow.
        """
        # `pin_progress`: part of their way that the pins have moved; another number for pins that act later
        self.release = self.pin_progress = release
        fabric = self.design.fabric
        sx, sy = self.released_stretch
        # parts that have a rest shape in the plane
        for name in {"membrane", "membrane_sides"} & self.parts.keys():
            cast(Membrane | SideMembrane, self.parts[name]).set_rest(self.mesh.points / (sx, sy))
        # bending coefficients depend on the rest shape only up to its size
        rest_shape = self.mesh.points / (sx / sy, 1.0) if len(set(fabric.stretch_xy)) > 1 else None
        self.bending.set_rest(self.parts, fabric.bending_tensor, 1.0 / (sx * sy), rest_shape)
        net = self.network
        step = self.mesh.points[net.edges[:, 1]] - self.mesh.points[net.edges[:, 0]]
        length = np.linalg.norm(step, axis=1)
        partly = fabric.model_copy(update={"stretch": (sx, sy)})
        along = step / length[:, None]
        kappa = rest_curvature(self.edge_thickness, partly, self.design.plastic, along)
        tau = rest_twist(self.edge_thickness, partly, self.design.plastic, along)
        # plastic below is the mirror image of plastic above
        kappa, tau = self.edge_side * (kappa + self._own_residual_curvature), self.edge_side * tau
        span = length[net.stencil_edges].sum(axis=1)
        self.parts["rod_bending"].params[:, 2] = 0.5 * kappa[net.stencil_edges].mean(axis=1) * span
        self.parts["rod_twist"].params[:, 3] = -0.5 * tau[net.stencil_edges].mean(axis=1) * span
        if "rod_joints" in self.parts:
            edge = self.joints.edge
            self.parts["rod_joints"].params[:, 3] = 0.5 * kappa[edge] * length[edge]
            self.parts["rod_joints"].params[:, 7] = -0.5 * tau[edge] * length[edge]
        # a sheet without supports lies on the ground until its first pins take hold
        self.load = release * self._weight if self.constraints.held.any() else np.zeros_like(self._weight)

    @property
    def released_stretch(self) -> tuple[float, float]:
        """Length of the print over that of the free fabric at the present release, along x and y."""
        sx, sy = self.design.fabric.stretch_xy
        return 1.0 + self.release * (sx - 1.0), 1.0 + self.release * (sy - 1.0)

    @property
    def spacing(self) -> float:
        """mm, distance of adjacent stars of the lattice."""
        return self.layout.spacing_mm

    def printed_state(self) -> State:
        """The flat print, plastic side up."""
        frames = np.tile(np.eye(3), (len(self.joints.vertices), 1, 1))
        return State(self.constraints.printed.copy(), np.tile([0.0, 0.0, 1.0], (len(self.edges), 1)), frames)

    def moved_to(self, state: State, positions: Array) -> State:
        """The state moved to other positions (V, 3) mm: directors are carried along, and joints follow their rods."""
        return self.with_fitted_frames(moved_state(state, self.edges, positions, np.zeros(len(self.edges))))

    def with_fitted_frames(self, state: State) -> State:
        """The state with each joint turned as its rods are on average."""
        if not len(self.joints.vertices):
            return state
        where = state.positions, state.directors
        return replace(state, frames=fitted_frames(self.joints, self.edges, self.mesh.points, *where))

    def flat_state(self) -> State:
        """The print with its held components at their positions for the present `pin_progress`."""
        return self.apply_supports(self.printed_state())

    def apply_supports(self, state: State) -> State:
        """The state with its held components at their positions for the present `pin_progress`.

        The rest of the sheet follows with as little deformation as possible.
        """
        held, places = self.constraints.held, self.constraints.positions_at(self.pin_progress)
        if not held.any() or np.array_equal(state.positions[held], places[held]):
            return state
        return self.with_fitted_frames(
            self.reconstruction.move_supports(state, np.where(held, places, state.positions))
        )

    @property
    def reconstruction(self) -> Reconstruction:
        """The least-squares reconstruction of positions from gradients, built at its first use."""
        if self._reconstruction is None:
            membrane, (ea, length) = cast(Membrane, self.parts["membrane"]).whole, self.parts["rod_stretch"].params.T
            self._reconstruction = Reconstruction(
                self.mesh.triangles,
                self.network.edges,
                membrane[:, :6].reshape(-1, 3, 2),
                membrane[:, 6],
                ea / length,
                self.constraints.held,
            )
        return self._reconstruction

    def path(self, state: State, direction: Array) -> tuple[Callable[[float], State], float]:
        """Curve of states that leaves `state` in `direction` (free,), and the largest step along it.

        Triangles and rod edges rotate along it, which straight steps would stretch to second order.
        """
        return self.reconstruction.path(state, *self.motions(direction))


def fabric_energies(fabric: Fabric, mesh: BendingMesh) -> dict[str, Elements]:
    """The fabric's membrane and its bending energies on the print, by name.

    With the paper's hinges the membrane is that of the paper, constant strain triangles.
    """
    bending, share = bending_of(fabric), None
    sides: dict[str, Elements] = {}
    if bending.needs_neighbours:
        share = flat_share(mesh.triangles, mesh.closed_hinges is not None)
        sides = {"membrane_sides": SideMembrane(mesh.hinges, mesh.printed, fabric)}
    membrane = {"membrane": Membrane(mesh.triangles, mesh.printed, fabric, share)}
    stiffness = fabric.bending_tensor
    if fabric.is_orthotropic:
        # the released shape at the size of the print, by coordinates along and across the direction that bends less:
        # where the fabric is sheared, curvatures are along this direction and at right angles to it
        (sx, sy), axes = fabric.stretch_xy, fabric.axes
        if stiffness.d22 > stiffness.d11:
            axes, stiffness = axes[:, ::-1] * [1.0, -1.0], stiffness.turned
        mesh = replace(mesh, printed=mesh.printed * np.sqrt([sy / sx, sx / sy]) @ axes)
    return membrane | sides | bending.build(mesh, stiffness)


def _networks(graph: RodGraph, mesh: Mesh) -> tuple[RodNetwork, JointNetwork]:
    """The rods of a graph on a mesh, and their joints."""
    starts = np.array([rod.start for rod in graph.rods], dtype=np.int64)
    junction = np.where(np.isin(starts, graph.paired), starts, -1)
    network = rod_network(mesh.rods, junction, mesh.points, graph.links)
    return network, joint_network(mesh.rods, [graph.ends_at[node] for node in graph.joints])


def _sections_at_midpoints(network: RodNetwork, graph: RodGraph) -> Array:
    """(R, K) sections at the midpoint of every rod edge."""
    first = np.searchsorted(network.rod, np.arange(len(graph.rods) + 1))  # edges are stored rod by rod
    pieces = [
        rod.at(rod.sections, network.midpoint[begin:end])
        for rod, begin, end in zip(graph.rods, first, first[1:], strict=False)
    ]
    return np.concatenate([np.empty((0, len(ROD_SIZES))), *pieces])


def bump_heights(model: DiscreteModel, state: State) -> Array:
    """(S,) mm, height of each star's centre above the mean of its tips, to its plastic's side; 0 without arms."""
    mesh, stars = model.mesh, model.layout.arm_star
    n_stars = len(model.layout.centres)
    tips = np.zeros((n_stars, 3))
    np.add.at(tips, stars, state.positions[[rod[-1] for rod in mesh.rods[: len(stars)]]])
    arms = np.bincount(stars, minlength=n_stars)[:, None]
    centre = state.positions[mesh.star_vertices]
    above_tips = np.where(arms > 0, centre - tips / np.maximum(arms, 1), 0.0)
    return np.asarray(model.layout.star_side * (above_tips * star_normals(model, state)).sum(axis=1))


def star_normals(model: DiscreteModel, state: State) -> Array:
    """(S, 3) unit vectors along the mean normal of each star's arms, up in print; zero without arms."""
    normal = np.zeros((len(model.layout.centres), 3))
    arms = model.network.rod < len(model.layout.arm_star)  # all rods, but those of a drawing
    np.add.at(normal, model.layout.arm_star[model.network.rod[arms]], state.directors[arms])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return normal / np.where(length > 0.0, length, 1.0)


def add_bumps(model: DiscreteModel, state: State, heights: Array) -> State:
    """The state with a Gaussian bump added at every star.

    `heights`: (S,) mm, to the side of each star's plastic; a star of height 0 does not change. Held components do not
    move.
    """
    bumped = np.flatnonzero(heights)
    if len(bumped) == 0:
        return state
    up = (model.layout.star_side * heights)[bumped]
    distance, nearest = cKDTree(model.layout.centres[bumped]).query(model.mesh.points)
    # radius at which a Gaussian bump falls to 1/e, over the spacing of the stars
    lift = up[nearest] * np.exp(-((distance / (0.35 * model.spacing)) ** 2))
    positions = state.positions + lift[:, None] * vertex_normals(state.positions, model.mesh.triangles)
    positions = np.where(model.constraints.held, state.positions, positions)
    return model.moved_to(state, positions)
