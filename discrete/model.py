"""The exact model of a design on a mesh: all its energies, their sum, its gradient and Hessian."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from discrete.constraints import pin_constraints
from discrete.elements import Array, Elements
from discrete.hinges import Hinges, interior_edges, paper_coefficients
from discrete.membrane import Membrane, membrane_params
from discrete.reconstruction import Reconstruction
from discrete.rigid import rigid_modes
from discrete.rod_bend import RodBend
from discrete.rod_stretch import RodStretch
from discrete.rod_twist import RodTwist
from discrete.rods import (
    bend_params,
    rod_network,
    stencil_inputs,
    stretch_params,
    twist_params,
)
from discrete.state import State, carried
from equilibrium.sparse_pattern import SparsePattern
from pattern.layout import Layout
from pattern.materials import rest_curvature
from pattern.mesh import Mesh

if TYPE_CHECKING:
    from pattern.design import Design

GRAVITY_M_S2 = 9.81


class Model:
    """Rods on a shell, between the stretched print (release 0) and the released design (release 1).

    Parameters
    ----------
    design, layout, mesh : what is printed, and its mesh.
    compiled : compiled loops (the default) or plain numpy.

    Attributes
    ----------
    parts : the energies by name: membrane, hinges (if the fabric bends), rod_bending, rod_stretch, rod_twist.
    pattern : of the Hessian over the free dofs: positions (3 V), then one twist a rod edge (R).
    """

    def __init__(self, design: Design, layout: Layout, mesh: Mesh, compiled: bool = True) -> None:
        self.design, self.layout, self.mesh = design, layout, mesh
        self.n_vertices = len(mesh.points)
        self.network = rod_network(mesh.rods, layout.arm_star, mesh.points)
        self.constraints = pin_constraints(layout, mesh)
        self._set_sections()
        self.parts = self._make_parts(compiled)
        held = np.concatenate([self.constraints.held.ravel(), np.zeros(len(self.network.edges), dtype=bool)])
        self.n_dofs = len(held)
        self.free = np.flatnonzero(~held)
        self.pattern = SparsePattern([e.dofs for e in self.parts.values()], self.n_dofs, self.free)
        self._weight = self._dead_load()
        self._reconstruction: Reconstruction | None = None
        self.release = 1.0
        self.set_release(1.0)

    # -- what it is made of -----------------------------------------------------------------------------------

    def _set_sections(self) -> None:
        """Thickness and width of every rod edge: linear along the arm."""
        net = self.network

        def along(ends: Array) -> Array:
            return ends[net.rod, 0] + net.middle * (ends[net.rod, 1] - ends[net.rod, 0])

        self.edge_thickness = along(self.layout.arm_thickness)
        self.edge_width = along(self.layout.arm_width)
        step = self.mesh.points[net.edges[:, 1]] - self.mesh.points[net.edges[:, 0]]
        self.edge_direction = step / np.linalg.norm(step, axis=1, keepdims=True)

    def _make_parts(self, compiled: bool) -> dict[str, Elements]:
        fabric, mesh, net = self.design.fabric, self.mesh, self.network
        plastic_modulus = fabric.modulus_mpa * self.design.plastic.modulus_ratio
        h, w = self.edge_thickness, self.edge_width
        parts: dict[str, Elements] = {
            "membrane": Membrane(
                mesh.triangles,
                mesh.points,
                fabric.thickness_mm,
                fabric.modulus_mpa,
                fabric.poisson,
                fabric.model == "incompressible",
                compiled,
            )
        }
        if fabric.bending == "consistent":
            raise ValueError('fabric.bending: "consistent" is not available; use "paper" or "none"')
        if fabric.bending == "paper":
            hinges = interior_edges(mesh.triangles)
            coefficient = paper_coefficients(
                hinges, mesh.points, fabric.thickness_mm, fabric.modulus_mpa, fabric.poisson
            )
            parts["hinges"] = Hinges(hinges, coefficient, compiled)
        inputs, dofs = stencil_inputs(net, self.n_vertices)
        edge_dofs = (3 * net.edges[:, :, None] + np.arange(3)).reshape(-1, 6)
        flat = np.zeros(len(net.edges))
        parts["rod_bending"] = RodBend(
            inputs, dofs, bend_params(net, mesh.points, plastic_modulus, w, h, flat), compiled
        )
        parts["rod_stretch"] = RodStretch(
            edge_dofs, edge_dofs, stretch_params(net, mesh.points, plastic_modulus, w, h), compiled
        )
        parts["rod_twist"] = RodTwist(
            inputs,
            dofs,
            twist_params(net, mesh.points, plastic_modulus, self.design.plastic.poisson, w, h),
            compiled,
        )
        return parts

    def _dead_load(self) -> Array:
        """(3 V,) N, the weight of fabric and plastic on the vertices; zero without gravity."""
        load = np.zeros((self.n_vertices, 3))
        gravity = self.design.gravity
        if gravity.on:
            corner = self.mesh.points[self.mesh.triangles]
            e1, e2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
            area = 0.5 * (e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0])
            mass = np.zeros(self.n_vertices)
            # kg/m^3 times mm^3 is 1e-9 kg
            fabric = 1e-9 * self.design.fabric.density_kg_m3 * self.design.fabric.thickness_mm * area / 3.0
            np.add.at(mass, self.mesh.triangles, fabric[:, None])
            length = self.parts["rod_stretch"].params[:, 1]
            rod = 1e-9 * self.design.plastic.density_kg_m3 * self.edge_thickness * self.edge_width * length / 2.0
            np.add.at(mass, self.network.edges, rod[:, None])
            direction = np.asarray(gravity.direction, dtype=float)
            load = mass[:, None] * GRAVITY_M_S2 * direction / np.linalg.norm(direction)
        return load.ravel()

    # -- between print and release ----------------------------------------------------------------------------

    def set_release(self, release: float) -> None:
        """Release the fabric from stretch 1 (0) to the design's stretch (1); pins and gravity go along."""
        self.release = release
        fabric = self.design.fabric
        sx, sy = (1.0 + release * (s - 1.0) for s in fabric.stretch_xy)
        partly = fabric.model_copy(update={"stretch": (sx, sy)})
        self.parts["membrane"].params[:] = membrane_params(
            self.mesh.triangles,
            self.mesh.points / (sx, sy),
            fabric.thickness_mm,
            fabric.modulus_mpa,
            fabric.poisson,
            fabric.model == "incompressible",
        )
        kappa = rest_curvature(self.edge_thickness, partly, self.design.plastic, self.edge_direction)
        net = self.network
        span = self.parts["rod_stretch"].params[net.stencil_edges, 1].sum(axis=1)
        self.parts["rod_bending"].params[:, 2] = 0.5 * kappa[net.stencil_edges].mean(axis=1) * span

    def flat_state(self) -> State:
        """The print as it lies: flat, plastic up, held vertices at their places for the present release."""
        positions = self.constraints.printed.copy()
        directors = np.tile([0.0, 0.0, 1.0], (len(self.network.edges), 1))
        return self.moved_pins(State(positions, directors))

    def moved_pins(self, state: State) -> State:
        """The state with its held components where the present release puts them, and the rest moved along."""
        held, places = self.constraints.held, self.constraints.places(self.release)
        if not held.any() or np.array_equal(state.positions[held], places[held]):
            return state
        return self.reconstruction.moved(state, np.where(held, places, state.positions))

    # -- energy and derivatives -------------------------------------------------------------------------------

    @property
    def load(self) -> Array:
        """(3 V,) N, dead load at the present release."""
        return self.release * self._weight

    def energies(self, state: State) -> dict[str, float]:
        """N mm, by part."""
        packed = state.packed
        with np.errstate(all="ignore"):
            out = {name: float(part.energies(packed).sum()) for name, part in self.parts.items()}
        if self._weight.any():
            out["gravity"] = -float(self.load @ state.positions.ravel())
        return out

    def energy(self, state: State) -> float:
        """N mm; not a number or infinite where the fabric has collapsed."""
        return sum(self.energies(state).values())

    def full_gradient(self, state: State) -> Array:
        """(3 V + R,) N and N mm over all dofs; at held ones it is minus the reaction."""
        packed = state.packed
        total = np.zeros(self.n_dofs)
        for part in self.parts.values():
            total += np.bincount(part.dofs.ravel(), part.gradients(packed).ravel(), self.n_dofs)
        total[: 3 * self.n_vertices] -= self.load
        return total

    def gradient(self, state: State) -> Array:
        """(free,) N and N mm."""
        return self.full_gradient(state)[self.free]

    def hessian(self, state: State, blend: float) -> Array:
        """(nnz,) entries of the lower triangle in `pattern`."""
        packed = state.packed
        return self.pattern.assemble([part.hessians(packed, blend) for part in self.parts.values()])

    def path(self, state: State, direction: Array, straight: bool = False) -> tuple[Callable[[float], State], float]:
        """Curve of states leaving `state` in `direction` (free,), and the longest step along it."""
        full = np.zeros(self.n_dofs)
        full[self.free] = direction
        move, turn = full[: 3 * self.n_vertices].reshape(-1, 3), full[3 * self.n_vertices :]
        if straight:
            return (lambda a: carried(state, self.network.edges, state.positions + a * move, a * turn)), 1.0
        return self.reconstruction.path(state, move, turn)

    @property
    def reconstruction(self) -> Reconstruction:
        """Positions from gradients; made when first asked for."""
        if self._reconstruction is None:
            self._reconstruction = Reconstruction(self)
        return self._reconstruction

    def rigid_modes(self, state: State) -> Array:
        """(free, k) orthonormal rigid motions that the pins leave free."""
        return rigid_modes(state, self.network.edges, self.constraints.held, self.free)
