"""The exact shape of a design: layout, mesh, model, equilibrium and summary.

The bond between plastic and fabric is among its fields: the line force with which the fabric pulls at the rods.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from asterism.discrete.energies.contact import ipc_toolkit
from asterism.discrete.energies.rods.network import rod_curvatures
from asterism.discrete.model.contact_model import ContactModel
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State, edge_tangents
from asterism.discrete.release.continuation import Report
from asterism.discrete.release.equilibrium import Equilibrium, roll_axis_deg
from asterism.discrete.release.forms import ExactForm, Minima, find_minima, stars_off_branch
from asterism.discrete.release.levels import Ladder, MeshLevel, SharedSearch, error_of_levels, solve_on_meshes
from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.backends import check_backend
from asterism.equilibrium.threads import one_blas_thread
from asterism.pattern.design.design import Design
from asterism.pattern.design.section import is_whole
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.free_motions import check_weight_is_supported
from asterism.pattern.layout.layout import Layout
from asterism.process.progress import Say, ignore_line
from asterism.results.records.exact import (
    BondRecord,
    ContactRecord,
    ExactRecord,
    LevelRecord,
    MinimumRecord,
    PathStepRecord,
    StartsRecord,
    off_branch,
)
from asterism.results.words import passing
from asterism.shape.measures import pin_warnings, shape_numbers, site_warnings, sizing_warnings
from asterism.shape.shape import Shape
from asterism.shape.surface import cell_fields, point_fields, self_intersections

# values of the key `result_is`: the reason why this minimum is the result
FROM_DEFAULT_START = "the default start's"
BY_ENERGY = "lowest energy"
BY_ENERGY_ON_BRANCH = "lowest energy of those whose stars are all on their branch"


@one_blas_thread()
def exact_shape(
    design: Design,
    backend: str = "auto",
    report: Report | None = None,
    say: Say | None = None,
    starts: int = 1,
    near: Shape | None = None,
    plan: Layout | None = None,
    edge_mm: float | None = None,
    shared: SharedSearch | None = None,
) -> Shape:
    """Compute an equilibrium of the exact model, from the design's start, from a given shape, or from many starts.

    Parameters
    ----------
    backend, report, say : as in `asterism.simulate`, and so are the errors.
    starts : number of different starts. With more than one, the result is the lowest minimum whose stars are all on
        the side that the design asks for, or the lowest of all if no minimum has that. `Shape.others` holds the other
        minima, and the summary's `minima` compares them.
    near : shape of the same design, such as its preview, that replaces the design's start. Each star bumps to the side
        that the design asks for. Requires `starts` = 1.
    plan : layout of the design; computed by default.
    edge_mm : of a single mesh. The shape then follows `near` to the next minimum, and has no estimate of its mesh
        error; coarser meshes first find low minima from afar. With one start only.
    shared : the meshes of this design and plan, and the states of an earlier search, where this
        one ends as soon as it reaches the same state on a coarse mesh. With one start only.

    Returns
    -------
    The shape. The principal axes of a free sheet lie along x, y and z.
    """
    if not is_whole(starts) or starts < 1:
        raise ValueError(f"starts = {starts!r}: must be a whole number, at least 1")
    if near is not None and starts != 1:
        raise ValueError("near goes with one start")
    check_backend(backend)
    announce = say or ignore_line
    start = time.perf_counter()
    plan = plan if plan is not None else layout(design)
    if design.solver.contact:
        ipc_toolkit()  # fails at once if the library is missing
    check_weight_is_supported(design, plan)
    search = shared or SharedSearch(Ladder(design, plan, edge_mm))
    ladder = search.ladder
    stars, rods = f"{len(plan.centres)} stars", f"{len(plan.drawn_rods)} rods"
    printed = " and ".join([*([stars] if plan.has_stars else []), *([rods] if plan.drawn_rods else [])])
    announce(f"{printed} on {_meshes(ladder)}")
    before = {"mesh and model": time.perf_counter() - start}
    if starts == 1:
        equilibrium, levels = solve_on_meshes(search, backend, report, near.at if near else None)
        minima = one_minimum(ladder.models[len(levels) - 1], equilibrium, near is not None)
        ends = [(equilibrium, levels)]
    else:
        found = find_minima(ladder, starts, backend, report)
        minima = many_minima(found, starts)
        ends = [(branch.equilibrium, list(branch.levels)) for branch in found.fine]
    more = vars(minima) | {"wall_s": time.perf_counter() - start}
    if starts == 1 and search.joined_at:
        more["joined_at_vertices"] = search.joined_at
    best, *others = (
        _shape(ladder, end, levels, more | {"wall_s_by_stage": before | end.seconds}) for end, levels in ends
    )
    return replace(best, others=tuple(others))


def _meshes(ladder: Ladder) -> str:
    """The meshes of a search in words."""
    if ladder.tolerance_percent is not None:
        return f"meshes refined until the error is within {ladder.tolerance_percent:g} %"
    mesh = ladder.models[-1].mesh
    return f"{len(mesh.triangles)} triangles ({mesh.kind} mesh)"


def _shape(ladder: Ladder, equilibrium: Equilibrium, levels: list[MeshLevel], more: dict[str, Any]) -> Shape:
    """The shape of an equilibrium with its fields and summary; `more` are the entries about the search."""
    model, edge_mm = ladder.models[len(levels) - 1], ladder.edges[len(levels) - 1]
    mesh, plan, fabric = model.mesh, model.layout, model.design.fabric
    star = np.full(len(mesh.points), -1, dtype=np.int64)
    star[mesh.star_vertices] = plan.star_number
    shape = Shape(
        printed=mesh.points,
        positions=_grounded(model, equilibrium.state.positions),
        triangles=mesh.triangles,
        star=star,
        rods=mesh.rods,
        star_vertices=mesh.star_vertices,
        rod_fields=_rod_fields(model, equilibrium),
        held=bool(model.held.any()),
        plan=plan,
    )
    if not shape.held:
        shape = shape.aligned()
    error = error_of_levels(levels)
    record = ExactRecord(
        model=ExactRecord.model_name,
        **shape_numbers(plan, shape, equilibrium, roll_axis_deg(model, equilibrium.state)),
        smallest_eigenvalue=equilibrium.smallest_eigenvalue,
        eigenvalue_error=equilibrium.eigenvalue_error,
        rods_total=len(plan.graph.rods),
        joints_total=len(plan.graph.joints),
        stars_total=len(plan.centres),
        stars_up=equilibrium.stars_up,
        stars_down=plan.star_number[equilibrium.sides < 0].tolist(),
        stars_off_branch=plan.star_number[stars_off_branch(model, equilibrium)].tolist(),
        dofs=len(model.free),
        mesh=mesh.kind,
        edge_mm=edge_mm,
        **vars(_bond(shape)),
        self_intersections=self_intersections(shape.positions, shape.triangles),
        self_contact=_contact(model, equilibrium),
        fabric_bending=fabric.bending,
        fabric_bending_n_mm=model.bending.energy(equilibrium.energies),
        instabilities_passed=equilibrium.instabilities_passed,
        backend=equilibrium.backend,
        design=model.design.to_dict(),
        mesh_error_percent=None if fabric.bending_follows_mesh else error.percent,
        mesh_change_percent=error.change_percent,
        mesh_forms_differ=error.forms_differ,
        mesh_tolerance_percent=None if model.design.mesh_edge_mm else model.design.mesh.tolerance_percent,
        levels=[LevelRecord(**vars(level)) for level in levels],
        path=[PathStepRecord(**vars(step)) for step in equilibrium.path],
        **more,
    )
    return replace(
        shape,
        point_fields=point_fields(shape.positions, shape.triangles),
        cell_fields=cell_fields(shape.printed, shape.positions, shape.triangles, fabric.stretch_xy),
        # scripts read each part of the energy as a key
        summary=record | equilibrium.energies | {"warnings": exact_warnings(record, model.design, plan)},
    )


def exact_warnings(record: ExactRecord, design: Design, layout: Layout) -> list[str]:
    """One line for each warning. The record holds every entry but `warnings`."""
    lines = []
    if not record.converged:
        gradient = f"gradient {record.gradient_norm:.1e} N is above {record.gradient_tolerance:.1e} N"
        lines.append(f"not an equilibrium: {gradient}")
    elif not record.is_minimum:
        lines.append(f"not a minimum: smallest eigenvalue {record.smallest_eigenvalue:.1e} N/mm is not positive")
    if pairs := record.self_intersections:
        remedy = "; --contact prevents this" if record.self_contact is None else ""
        lines.append(f"{passing(pairs)}{remedy}")
    # a search that ended at its largest mesh, above its tolerance
    error, tolerance = record.mesh_error_percent, record.mesh_tolerance_percent
    ended = f"the search ended at {record.vertices} vertices"
    if tolerance is not None and error is not None and error > tolerance:
        lines.append(f"the mesh error, about {error:.1f} %, is above the tolerance of {tolerance:g} %: {ended}")
    elif tolerance is not None and record.mesh_forms_differ:
        change = f"{record.mesh_change_percent:.1f} % of the diameter apart"
        lines.append(f"the last two meshes have different forms, {change}: {ended}")
    rolls = not layout.is_supported_in_plane and record.roll_axis_deg is not None
    # edge length over the spacing of the stars, above which the radius of a free roll depends on the mesh of hinges
    if rolls and design.fabric.bending_follows_mesh and record.edge_mm > 0.03 * layout.spacing_mm:
        depends = "the radius of a free roll depends on the mesh"
        lines.append(
            f"{depends}: for the gallery's tube it differs by a quarter between edges of 2 mm and 0.5 mm (docs: mesh)"
        )
    of_design = [*site_warnings(layout), *sizing_warnings(design, layout), *pin_warnings(layout, design.gravity.on)]
    return [*lines, *off_branch(record), *of_design]


def _grounded(model: DiscreteModel, positions: np.ndarray) -> np.ndarray:
    """(V, 3) mm. If the supports leave the height free, the lowest supported vertex moves to z = 0."""
    held = model.constraints.held
    if held[:, 2].any() or not held.any():
        return positions
    return np.asarray(positions - [0.0, 0.0, positions[held.any(axis=1), 2].min()])


def _rod_fields(model: DiscreteModel, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
    net = model.network
    bend = np.zeros(len(net.edges))
    touched = np.zeros(len(net.edges))
    curvature = rod_curvatures(net, equilibrium.state.positions, equilibrium.state.directors, model.mesh.points)
    # an edge takes the mean of the stencils along its own arm; a stencil across a junction belongs to two arms
    own = net.signs[:, 0] > 0
    np.add.at(bend, net.stencil_edges[own], curvature[own, None])
    np.add.at(touched, net.stencil_edges[own], 1.0)
    fields = {
        "arm": net.rod,
        "star": model.layout.star_of_rods[net.rod],
        "thickness_mm": model.edge_thickness,
        "width_mm": model.edge_width,
        "curvature_per_mm": model.edge_side
        * np.divide(bend, touched, out=np.full(len(bend), np.nan), where=touched > 0),
    }
    if (model.edge_side < 0).any():
        fields["side"] = model.edge_side
    if model.design.fabric.has_forces and len(net.edges):
        fields |= line_forces(model, equilibrium.state)
    return fields


def _bond(shape: Shape) -> BondRecord:
    if "peel_n_per_mm" not in shape.rod_fields:
        return BondRecord(peel_n_per_mm=None, peel_star=None, peel_at_mm=None, shear_n_per_mm=None)
    peel, star = shape.rod_fields["peel_n_per_mm"], shape.rod_fields["star"]
    edge = int(np.argmax(peel))
    return BondRecord(
        peel_n_per_mm=max(float(peel[edge]), 0.0),
        peel_star=int(star[edge]) if star[edge] >= 0 else None,
        peel_at_mm=shape.printed[shape.rod_edges[edge]].mean(axis=0).tolist(),
        shear_n_per_mm=float(shape.rod_fields["shear_n_per_mm"].max()),
    )


def _contact(model: DiscreteModel, equilibrium: Equilibrium) -> ContactRecord | None:
    """Contacts of the sheet with itself; None if the model ran without contact."""
    if not isinstance(model, ContactModel):
        return None
    pairs, smallest_gap = model.contact.pairs_and_gap(equilibrium.state.positions)
    return ContactRecord(
        begins_at_mm=model.contact.distance,
        closest_possible_mm=model.contact.min_distance,
        least_distance_mm=smallest_gap if pairs else None,
        pairs=pairs,
    )


def line_forces(model: DiscreteModel, state: State) -> dict[str, Floats]:
    """The forces of the fabric on the rods for each mm of rod, in equilibrium, as means over pieces of the rods.

    Returns
    -------
    `peel_n_per_mm` : (R,) at the rod edges, away from the plastic at a right angle to the bond; negative where the
    fabric presses on it. `shear_n_per_mm` : (R,) in the plane of the bond, along and across the rod.

    Notes
    -----
    Rods and fabric share vertices. In equilibrium the fabric holds each vertex against the force of the rods, the
    negative gradient of their energies, so it pulls at the rods with their gradient. The rods' own weight, about
    1e-5 N/mm, counts as a force of the fabric. Rods that meet at a vertex share its force by their lengths there.
    Every rod is divided into equal pieces of at least two widths: at a tip the force of a line on a sheet is singular,
    and what happens within a width is beyond the model. Means over two widths converge with the mesh.
    """
    net, n_vertices = model.network, model.n_vertices
    packed = state.packed
    force = np.zeros(model.n_dofs)
    for name, part in model.parts.items():
        if name.startswith("rod_"):
            force += np.bincount(part.dofs.ravel(), part.gradients(packed).ravel(), model.n_dofs)
    length = np.linalg.norm(model.mesh.points[net.edges[:, 1]] - model.mesh.points[net.edges[:, 0]], axis=1)
    at_vertex = np.bincount(net.edges.ravel(), np.repeat(0.5 * length, 2), n_vertices)
    density = force[: 3 * n_vertices].reshape(-1, 3) / np.maximum(at_vertex, 1e-300)[:, None]

    # along all rods, one after the other: the force in the frames of the edges, summed up over half edges
    tangent, normal = edge_tangents(state.positions, net.edges), state.directors
    frames = np.stack([tangent, np.cross(normal, tangent), normal], axis=1)
    on_halves = np.einsum("rij,rhj->rhi", frames, density[net.edges]) * 0.5 * length[:, None, None]
    total = np.vstack([np.zeros(3), np.cumsum(on_halves.reshape(-1, 3), axis=0)])
    place = np.concatenate([[0.0], np.cumsum(np.repeat(0.5 * length, 2))])

    of_rod = np.bincount(net.rod, length)
    first = (np.cumsum(of_rod) - of_rod)[net.rod]
    widths = of_rod**2 / np.bincount(net.rod, length * model.edge_width)
    piece = (of_rod / np.maximum(np.floor(0.5 * widths), 1.0))[net.rod]
    begin = first + piece * np.floor((place[1::2] - first) / piece)
    along, across, off = (
        (np.interp(begin + piece, place, each) - np.interp(begin, place, each)) / piece for each in total.T
    )
    return {"peel_n_per_mm": -model.edge_side * off, "shear_n_per_mm": np.hypot(along, across)}


def one_minimum(model: DiscreteModel, equilibrium: Equilibrium, near: bool = False) -> StartsRecord:
    """The record of a single start: the default one, or, if `near`, a shape that the caller gave."""
    axis = roll_axis_deg(model, equilibrium.state)
    entry = MinimumRecord(energy_n_mm=equilibrium.energy, stars_up=equilibrium.stars_up, roll_axis_deg=axis, starts=1)
    return StartsRecord(
        starts=1,
        result_is="from a shape that was given" if near else FROM_DEFAULT_START,
        minima_seen=1,
        minima=[entry],
        next_minimum_percent=None,
    )


def many_minima(minima: Minima, starts: int) -> StartsRecord:
    """The record of many starts."""
    fine, coarse = minima.fine, minima.coarse
    not_carried = minima.refined.count(False)
    return several_minima(
        [_entry(each, minima) for each in fine],
        [[minima.distance_percent(a, b) for b in fine] for a in fine],
        fine[0].equilibrium.energies.get("gravity", 0.0),
        not_carried,
        starts=starts,
        starts_lost=minima.lost_starts,
        symmetries=len(minima.symmetries),
        minima_coarse=[_entry(b, minima) | {"carried": kept} for b, kept in zip(coarse, minima.refined, strict=True)],
    )


def several_minima(
    entries: Sequence[MinimumRecord],
    distances_percent: list[list[float]],
    gravity_n_mm: float,
    not_carried: int = 0,
    **more: Any,
) -> StartsRecord:
    """The record of distinct minima, of which the first is the result.

    Parameters
    ----------
    gravity_n_mm : the part of gravity in the energy of the result. Its zero level is arbitrary, so that energies are
        compared relative to the rest.
    more : keys about the starts.
    """
    lowest, others = entries[0].energy_n_mm, [each.energy_n_mm for each in entries[1:]]
    higher, elastic = min(others) - lowest if others else None, lowest - gravity_n_mm
    return StartsRecord(
        result_is=BY_ENERGY if higher is None or higher >= 0.0 else BY_ENERGY_ON_BRANCH,
        minima_seen=len(entries) + not_carried,
        minima_not_carried=not_carried,
        next_minimum_percent=None if higher is None else 100.0 * higher / elastic if elastic else math.inf,
        next_minimum_n_mm=higher,
        minima=[each | {"file": f"minimum-{k}" if k > 1 else "shape"} for k, each in enumerate(entries, 1)],
        minima_distance_percent=distances_percent,
        **more,
    )


def _entry(branch: ExactForm, minima: Minima) -> MinimumRecord:
    equilibrium = branch.equilibrium
    return MinimumRecord(
        energy_n_mm=equilibrium.energy,
        is_minimum=equilibrium.is_minimum,
        stars_up=equilibrium.stars_up,
        stars_off_branch=len(branch.stars_off_branch),
        roll_axis_deg=branch.roll_axis_deg,
        starts=len(branch.starts),
        start_names=list(branch.starts),
        default=branch.default,
        distance_percent=minima.distance_percent(minima.fine[0], branch),
        smallest_eigenvalue=equilibrium.smallest_eigenvalue,
        vertices=branch.model.n_vertices,
    )
