"""V21: an independent C++ implementation of the same energies.

Energy, gradient and Hessian agree at random states: membrane and hinges as they are, rods once its conventions are
ours (`rods`). The equilibria agree to 1e-8 of the diameter with those conventions. With the model as it is
they differ by a tenth of a percent in shape and a third of a percent in energy: that is all due to the stretch of
the rods (counted three to six times over, by the stencils) and to their twist.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.discrete.energies.bending.fabric_bending import interior_edges
from asterism.discrete.energies.bending.hinges import Hinges, hinge_coefficients
from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.membrane import Membrane
from asterism.discrete.energies.rods.network import RodNetwork, bend_params, rod_network, stencil_inputs, stencil_length
from asterism.discrete.energies.rods.rod import RodBend, RodTwist
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State, edge_tangents
from asterism.discrete.model.system import System
from asterism.discrete.release.continuation import force_scale, solve_on_mesh
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.newton.minimise import minimise
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric, rest_curvature
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh
from tests.discrete.plain import plain_energies, plain_gradients, plain_hessians
from tests.discrete.test_fabric import counterclockwise
from tests.distances import rms_distance

FOLDER = Path(__file__).parent.parent / "data" / "reference"
SPACING = 10.0 * np.sqrt(3.0)


def load(name: str) -> dict[str, Array]:
    """Arrays of a file."""
    with np.load(FOLDER / f"{name}.npz") as file:
        return dict(file)


def fabric(data: dict[str, Array]) -> dict[str, Elements]:
    """Membrane and hinges as the model has them."""
    points = data["vertices_flat"][:, :2]
    triangles = counterclockwise(points, data["triangles"].astype(np.int64))
    sheet = Fabric(thickness_mm=float(data["h2"]), modulus_mpa=float(data["E2"]), poisson=float(data["nu"]))
    hinges = interior_edges(triangles)
    return {
        "membrane": Membrane(triangles, points / float(data["s"]), sheet),
        "hinge": Hinges(hinges, hinge_coefficients(hinges, points, sheet.bending_tensor.d11)),
    }


class ReferenceStretch(Elements):
    """`c l/8 (|e|^2/l^2 - 1)^2`; params (N, 2): c (N), printed length l (mm)."""

    def __init__(self, dofs: Array, params: Array) -> None:
        super().__init__(dofs, dofs, params)
        self.formulas = (_stretch_energy, _stretch_gradient, _stretch_hessian)

    def energies(self, configuration: Array) -> Array:
        return plain_energies(self, configuration)

    def gradients(self, configuration: Array) -> Array:
        return plain_gradients(self, configuration)

    def hessians(self, configuration: Array, blend: float = 0.0, rows: slice = slice(None)) -> Array:
        return plain_hessians(self, configuration, blend)[rows]


def _edge(q: Array, p: Array) -> tuple[Array, Array]:
    e = q[3:] - q[:3]
    return e, (e * e).sum(axis=0) / p[1] ** 2 - 1.0


def _stretch_energy(q: Array, p: Array) -> Array:
    return p[0] * p[1] / 8.0 * _edge(q, p)[1] ** 2


def _stretch_gradient(q: Array, p: Array, g: Array) -> None:
    e, strain = _edge(q, p)
    g[3:] = p[0] / (2.0 * p[1]) * strain * e
    g[:3] = -g[3:]


def _stretch_hessian(q: Array, p: Array, blend: float, h: Array) -> None:
    e, strain = _edge(q, p)
    scale = p[0] / (2.0 * p[1])
    for r in range(3):
        for c in range(3):
            block = scale * (2.0 * e[r] * e[c] / p[1] ** 2 + (strain if r == c else 0.0))
            h[r, c], h[3 + r, 3 + c] = block, block
            h[3 + r, c], h[r, 3 + c] = -block, -block


def rods(network: RodNetwork, points: Array, modulus: float, width: Array, thickness: Array, rest: Array) -> dict:
    """The three energies of rods as the reference has them.

    Half the bending stiffness of the continuum; the mean of the two bending stiffnesses in place of GJ; a Green strain
    that every stencil adds to both of its edges, with the cross-section of the first rod in all arms and the mean one,
    in full, at junctions; stiffnesses from mean width and thickness, not their means, at junctions.

    Parameters
    ----------
    width, thickness : (R,) mm, of every edge.
    rest : (S,) integrated rest curvatures about the width.
    """
    inputs, dofs = stencil_inputs(network, len(points))
    w, h = (values[network.stencil_edges].mean(axis=1) for values in (width, thickness))
    span = stencil_length(network, points)
    half = 0.5 * network.weight / span
    about_width, in_plane = (modulus * a for a in (w * h**3 / 12.0, h * w**3 / 12.0))
    turn = bend_params(network, points, modulus, width, thickness, np.zeros(len(width)))[:, 3]
    bend = np.column_stack([about_width * half, in_plane * half, rest, turn, network.signs])
    twist = np.column_stack([0.5 * (about_width + in_plane) * half, network.signs, np.zeros(len(half))])
    junction = network.weight < 1.0
    area = np.where(junction, w * h, width[0] * thickness[0])
    stiffness = np.zeros(len(width))
    np.add.at(stiffness, network.stencil_edges, modulus * area[:, None])
    length = np.linalg.norm(points[network.edges[:, 1]] - points[network.edges[:, 0]], axis=1)
    edge_dofs = (3 * network.edges[:, :, None] + np.arange(3)).reshape(-1, 6)
    return {
        "rod_bending": RodBend(inputs, dofs, bend),
        "rod_twist": RodTwist(inputs, dofs, twist),
        "rod_stretch": ReferenceStretch(edge_dofs, np.column_stack([stiffness, length])),
    }


def paths(data: dict[str, Array]) -> tuple[Array, ...]:
    """Vertex path of every rod."""
    return tuple(path[path >= 0] for path in data["rods"])


def design(**plastic: Any) -> Design:
    """A design with the materials of the reference (they are the defaults); its stars and border are not used."""
    sheet = {"stars": {"length_mm": 10}, "border": {"rings": 0}, "fabric": {"bending": "paper"}}
    return Design.from_dict(sheet | {"plastic": plastic})


def model(data: dict[str, Array]) -> DiscreteModel:
    """The exact model on the reference's mesh."""
    points, rod_paths = data["vertices_flat"][:, :2], paths(data)
    centres, star = np.unique([path[0] for path in rod_paths], return_inverse=True)
    layout = Layout(
        outline=data["border"],
        centres=points[centres],
        arm_star=star,
        arm_tip=points[[path[-1] for path in rod_paths]],
        arm_sections=np.stack([np.column_stack([data["rod_h"], data["rod_w"]])] * 2, axis=1),
        pins=(),
        lattice_vectors=SPACING * np.array([[np.sqrt(0.75), 0.5], [0.0, 1.0]]),
        lattice_origin=np.zeros(2),
    )
    triangles = counterclockwise(points, data["triangles"].astype(np.int64))
    mesh = Mesh(points, triangles, rod_paths, centres, data["boundary"], (), "delaunay")
    return DiscreteModel(design(), layout, mesh)


def final_state(model: DiscreteModel, data: dict[str, Array]) -> State:
    """The reference's equilibrium; directors from the surface, since arms hardly twist against it."""
    positions = data["final_positions"]
    corner = positions[model.mesh.triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    around = np.zeros_like(positions)
    np.add.at(around, model.mesh.triangles, normal[:, None, :])
    edges = model.edges
    directors = around[edges[:, 0]] + around[edges[:, 1]]
    t = edge_tangents(positions, edges)
    directors -= (directors * t).sum(axis=1, keepdims=True) * t
    return State(positions.copy(), directors / np.linalg.norm(directors, axis=1, keepdims=True))


@dataclass(frozen=True)
class RandomState:
    """The state of a file of derivatives, seen from our side: rods along their paths, directors along the plastic.

    `sign`: -1 for edges that run from a higher to a lower vertex; the reference turns those the other way round.
    """

    network: RodNetwork
    state: State
    sign: Array


def random_state(data: dict[str, Array]) -> RandomState:
    """Positions and directors from `X` and the frames."""
    points = data["vertices_flat"][:, :2]
    n = len(points)
    ends = paths(data)
    # the file's order of stencils: arms rod by rod, then the pairs of `rod_connections`
    stencils, edges = data["stencils"], np.concatenate([np.column_stack([p[:-1], p[1:]]) for p in ends])
    own = stencils[:, 3:] - 3 * n
    forward = edges[own, 0] == stencils[:, :2]
    rod = np.repeat(np.arange(len(ends)), [len(p) - 1 for p in ends])
    arm = rod[own[:, 0]] == rod[own[:, 1]]
    network = RodNetwork(
        edges, rod, np.zeros(len(edges)), stencils[:, :3], own, np.where(forward, 1.0, -1.0), np.where(arm, 1.0, 0.5)
    )
    sign = np.where(edges[:, 0] < edges[:, 1], 1.0, -1.0)
    angle = (sign * data["X"][3 * n :])[:, None]
    directors = np.cos(angle) * data["ref_d1"] + np.sin(angle) * data["ref_d2"]
    return RandomState(network, State(data["X"][: 3 * n].reshape(-1, 3), directors), sign)


def equilibrium_rods(model: DiscreteModel, data: dict[str, Array], modulus: float) -> dict[str, Elements]:
    """The reference's rods for one of its equilibria."""
    network = rod_network(paths(data), model.layout.arm_star, model.mesh.points)
    rest = 0.5 * data["rod_kappa"][network.rod][network.stencil_edges].mean(axis=1)
    width, thickness = data["rod_w"][network.rod], data["rod_h"][network.rod]
    rest = rest * stencil_length(network, model.mesh.points)
    return rods(network, model.mesh.points, modulus, width, thickness, rest)


DERIVATIVES = pytest.mark.parametrize("name", ["derivatives_A", "derivatives_B"])
EQUILIBRIA = pytest.mark.parametrize("name", ["star1", "stars7_thin", "stars37"])


def assembled(parts: dict[str, Elements], edges: Array, state: State) -> tuple[float, Array, Array]:
    """Energy, gradient and dense Hessian over all dofs."""
    n = 3 * len(state.positions) + len(edges)
    system = System(parts, len(state.positions), edges, np.zeros(n, dtype=bool))
    low = system.pattern.lower(system.hessian(state, 0.0)).toarray()
    return system.energy(state), system.full_gradient(state), low + np.tril(low, -1).T


def assert_close(found: tuple[float, Array, Array], data: dict[str, Array], part: str, tolerance: float) -> None:
    energy, gradient, hessian = found
    assert energy == pytest.approx(float(data[f"E_{part}"]), rel=tolerance)
    expected = data[f"g_{part}"]
    assert np.abs(gradient - expected).max() < tolerance * np.abs(expected).max()
    upper = np.triu(data[f"H_{part}"])
    expected = upper + np.triu(upper, 1).T
    assert np.abs(hessian - expected).max() < tolerance * np.abs(expected).max()


@DERIVATIVES
@pytest.mark.parametrize("part", ["membrane", "hinge"])
def test_fabric(name, part):
    data = load(name)
    n = len(data["vertices_flat"])
    directors = np.zeros((len(data["X"]) - 3 * n, 3))
    edges = random_state(data).network.edges
    state = State(data["X"][: 3 * n].reshape(-1, 3), directors)
    assert_close(assembled({part: fabric(data)[part]}, edges, state), data, part, 1e-10)


@DERIVATIVES
def test_rods(name):
    """B has permuted vertices, a rod run backwards, and rods of different cross-sections."""
    data = load(name)
    at = random_state(data)
    points, width, thickness = (
        data["vertices_flat"][:, :2],
        data["rod_w"][at.network.rod],
        data["rod_h"][at.network.rod],
    )
    parts = rods(at.network, points, float(data["E1"]), width, thickness, -data["restK"][:, 0])
    energy, gradient, hessian = assembled(parts, at.network.edges, at.state)
    sign = np.concatenate([np.ones(3 * len(points)), at.sign])
    assert_close((energy, sign * gradient, sign[:, None] * hessian * sign), data, "rod", 1e-8)


def distance(one: Array, other: Array) -> float:
    """rms distance after rigid alignment, over the diameter."""
    return rms_distance(one, other) / float(np.linalg.norm(np.ptp(other, axis=0)))


@EQUILIBRIA
def test_equilibrium_with_the_references_rods(name):
    """Nothing is left of the difference once stretch and twist of the rods are the reference's."""
    data = load(name)
    sheet = model(data)
    modulus = float(json.loads(str(data["params"]))["E1"])
    parts = {part: sheet.parts[part] for part in ("membrane", "hinges")}
    parts |= equilibrium_rods(sheet, data, modulus)
    system = System(parts, sheet.n_vertices, sheet.edges, sheet.held)
    factor = make_factor(system.pattern)
    found = minimise(system, final_state(sheet, data), factor, 1e-8 * force_scale(sheet))
    factor.close()
    assert found.converged and found.definite
    assert distance(found.state.positions, data["final_positions"]) < 1e-7
    assert found.energy == pytest.approx(float(data["E_total"]), rel=1e-10)
    energies = system.energies(found.state)
    rod = sum(energies[part] for part in ("rod_bending", "rod_twist", "rod_stretch"))
    for value, part in [(energies["membrane"], "membrane"), (energies["hinges"], "hinge"), (rod, "rod")]:
        assert value == pytest.approx(float(data[f"E_{part}"]), rel=1e-6)
    assert energies["rod_stretch"] == pytest.approx(float(data["E_rod_stretch"]), rel=1e-6)


@pytest.mark.parametrize("name", ["star1", "stars7_thin"])
def test_equilibrium_from_the_print(name):
    """The project's own start finds a minimum close by; every star is up. Measured: 0.02 and 0.09 %."""
    data = load(name)
    sheet = model(data)
    np.testing.assert_allclose(
        rest_curvature(data["rod_h"], sheet.design.fabric, sheet.design.plastic), data["rod_kappa"], rtol=1e-6
    )
    found = solve_on_mesh(sheet)
    assert found.is_minimum and found.stars_up == len(data["star_pos"])
    assert distance(found.state.positions, data["final_positions"]) < 2e-3
    # softer stretch: lower, by a third of a percent
    assert 0.995 < found.energy / float(data["E_total"]) < 1.0
