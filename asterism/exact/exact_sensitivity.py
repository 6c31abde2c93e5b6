"""Sensitivities of an exact shape: how its printed points move if the size of a star changes a little.

At an equilibrium, a small change dp of a size changes the gradient g of the energy at fixed positions by `(dg/dp) dp`,
and with the Hessian H the positions by `-H^-1` times that. The derivative of g is a difference of two models whose
meshes have the same triangles: the vertices of a longer arm move along it, the others stay. A fixed printed point then
lies at another place of its triangle, which moves it by minus the deformation gradient times the motion of the mesh.

Stars `EXACT_COLOUR_STEPS` lattice steps apart share no triangle and no hinge of their arms, so that they are changed
together. The change of the gradient at a vertex belongs to the nearest of the changed stars.
"""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.ladder import model_on
from asterism.discrete.release.prolongation import plastic_normals
from asterism.discrete.release.single_mesh import solve_on_mesh
from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.linear.rigid_support import stiffen
from asterism.equilibrium.threads import one_blas_thread
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.point_location import locate
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.painted_stars import SIZE_KEYS, with_painted_stars
from asterism.pattern.mesh.mesh import Mesh
from asterism.shape.shape import Shape

# lattice steps between stars that are changed together
EXACT_COLOUR_STEPS = 2
# mm, changes for the differences, of lengths and of thicknesses; both are far below what changes a shape visibly
EXACT_LENGTH_STEP_MM, EXACT_THICKNESS_STEP_MM = 0.005, 2e-4
# mm, largest distance of a shape from the equilibrium of the model on its mesh
MAX_EQUILIBRIUM_DISTANCE_MM = 0.01
# mm, printed points this far off the triangles are taken to them
OFF_CHORDS_MM = 0.25


class NoMinimumError(ValueError):
    """A shape is no minimum of the exact model of its design."""


class ExactSensitivity:
    """Sensitivities of the exact shape of a star design, without contact.

    Parameters
    ----------
    design : of the shape.
    shape : a minimum of the exact model.
    points : (n, 2) mm, printed points whose motion is computed.

    Raises
    ------
    NoMinimumError
        The shape is no minimum of the exact model of the design.
    ValueError
        The shape has the mesh of another design.

    Examples
    --------
    >>> from asterism.exact.simulation import exact_shape
    >>> design = Design.from_dict({"stars": {"length_mm": 6.0}, "border": {"rings": 0}, "mesh": {"edge_mm": 4.0}})
    >>> points = np.array([[4.0, 0.0], [0.0, 0.0]])
    >>> moves = ExactSensitivity(design, exact_shape(design), points).moves("thickness_mm")
    >>> moves.shape
    (2, 3, 1)
    """

    @one_blas_thread()
    def __init__(self, design: Design, shape: Shape, points: Floats) -> None:
        self._design, self._plan = design, layout(design)
        self._model = model = model_on(design, self._plan, shape.summary["edge_mm"])
        mesh = model.mesh
        if mesh.points.shape != shape.printed.shape:
            raise ValueError("shape: has the mesh of another design")
        start = State(shape.positions, plastic_normals(model, shape.positions))
        equilibrium = solve_on_mesh(model, model.with_fitted_frames(start))
        off = float(np.abs(equilibrium.state.positions - shape.positions).max())
        if not equilibrium.is_minimum or off > MAX_EQUILIBRIUM_DISTANCE_MM:
            raise NoMinimumError(f"shape: is no minimum of the exact model, which has one {off:.2g} mm away")
        self._state = equilibrium.state
        self._gradient = model.full_gradient(self._state)
        self._triangle, self._weights = locate(mesh.points, mesh.triangles, points, OFF_CHORDS_MM)

    @one_blas_thread()
    def moves(self, size: Literal["length_mm", "thickness_mm"]) -> Floats:
        """(n, 3, S) motion of the printed points per mm of one size of each star, without free rigid motions."""
        model, mesh, plan = self._model, self._model.mesh, self._plan
        step = EXACT_LENGTH_STEP_MM if size == "length_mm" else EXACT_THICKNESS_STEP_MM
        dof_points = self._dof_points()
        gradients = np.zeros((model.n_dofs, len(plan.centres)))
        shifts = np.zeros((*mesh.points.shape, len(plan.centres)))
        for stars in _exact_colours(plan):
            changed = self._changed(size, step, stars)
            after = layout(changed)
            other = DiscreteModel(changed, after, mesh_along_arms(mesh, plan, after))
            difference = (other.full_gradient(self._state) - self._gradient) / step
            shift = (other.mesh.points - mesh.points) / step
            tree = cKDTree(plan.centres[stars])
            owner, vertex_owner = tree.query(dof_points)[1], tree.query(mesh.points)[1]
            for number, star in enumerate(stars):
                gradients[owner == number, star] = difference[owner == number]
                shifts[vertex_owner == number, :, star] = shift[vertex_owner == number]
        moved = self._responses(gradients)
        return self._at_points(moved) - self._through_mesh(shifts)

    def _changed(self, size: str, step: float, stars: Ints) -> Design:
        column = SIZE_KEYS.index(size)
        sizes = np.full((len(stars), len(SIZE_KEYS)), np.nan)
        sizes[:, column] = self._plan.star_sizes_mm[stars, column] + step
        return with_painted_stars(self._design, self._plan.sites[stars], sizes)

    def _responses(self, gradients: Floats) -> Floats:
        """(V, 3, P) motion of the vertices for changes (dofs, P) of the gradient."""
        model, state = self._model, self._state
        data = model.hessian(state, 0.0)
        stiffen(model.pattern, data, model.support(state))
        with closing(model.factor()) as factor:
            factor.factorise(data)
            steps = -np.asarray(factor.solve(gradients[model.free]))
        rigid = model.rigid_modes(state)
        full = np.zeros_like(gradients)
        full[model.free] = steps - rigid @ (rigid.T @ steps)
        return full[: 3 * model.n_vertices].reshape(model.n_vertices, 3, -1)

    def _at_points(self, moves: Floats) -> Floats:
        """(n, ..., P) of the vertices (V, ..., P) at the printed points."""
        corners = self._model.mesh.triangles[self._triangle]
        return np.asarray(np.einsum("nk,nkap->nap", self._weights, moves[corners]))

    def _through_mesh(self, shifts: Floats) -> Floats:
        """(n, 3, P) motion of printed points that go with shifts (V, 2, P) of the mesh, on the present surface."""
        mesh = self._model.mesh
        corners = mesh.triangles[self._triangle]
        printed, placed = mesh.points[corners], self._state.positions[corners]
        across = (printed[:, 1:] - printed[:, :1]).transpose(0, 2, 1)
        gradient = (placed[:, 1:] - placed[:, :1]).transpose(0, 2, 1) @ np.linalg.inv(across)
        return np.asarray(np.einsum("nab,nbp->nap", gradient, self._at_points(shifts)))

    def _dof_points(self) -> Floats:
        """(dofs, 2) mm, printed vertex to which each degree of freedom belongs."""
        model, points = self._model, self._model.mesh.points
        owners = [np.repeat(points, 3, axis=0), points[model.edges[:, 0]]]
        return np.concatenate([*owners, np.repeat(points[model.joint_vertices], 3, axis=0)])


def _exact_colours(plan: Layout) -> list[Ints]:
    """Numbers of the stars that are changed together."""
    colours = (plan.sites % EXACT_COLOUR_STEPS) @ np.array([EXACT_COLOUR_STEPS, 1])
    return [np.flatnonzero(colours == colour) for colour in np.unique(colours)]


def mesh_along_arms(mesh: Mesh, before: Layout, after: Layout) -> Mesh:
    """The mesh with its rods along those of another layout, whose arms differ a little in length."""
    points = mesh.points.copy()
    for path, old, new in zip(mesh.rods, before.graph.rods, after.graph.rods, strict=True):
        along = np.linalg.norm(mesh.points[path] - old.points[0], axis=1)
        move = (new.points[-1] - old.points[-1]) - (new.points[0] - old.points[0])
        points[path] += (along / along[-1])[:, None] * move + (new.points[0] - old.points[0])
    return replace(mesh, points=points)
