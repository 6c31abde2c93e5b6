"""Everything that one unit cell says about an endless sheet of equal stars."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any, Self

import numpy as np

from discrete.energies.elements import Array
from equilibrium.clock import Clock
from homogenize.cell.arm_segments import arm_segments
from homogenize.cell.blend_responses import blend_responses
from homogenize.cell.cell_mesh import star_size
from homogenize.cell.cell_stability import CellStability, cell_stability
from homogenize.cell.corrugation_waves import CorrugationWaves
from homogenize.cell.effective_stiffness import EffectiveStiffness, effective_stiffness, mean_height
from homogenize.cell.flat_cell import FlatCell, relax_flat_cell
from homogenize.cell.isotropy import distance_from_isotropy
from homogenize.cell.natural_curvature import TubeBranch, trace_tubes
from homogenize.cell.rolling import Tube, centre_offset, heights_over_mean_surface
from homogenize.cell.tube_directions import MIN_RESOLVED_CURL, is_threefold, tube_angles
from homogenize.cell.tube_membrane import tube_membrane_stiffness
from homogenize.cell.unit_cell import UnitCell
from pattern.design.design import Design
from pattern.design.errors import DesignError


@dataclass(frozen=True)
class Sample:
    """Responses of the cell of one star; the mean of two where its arms are cut in two ways (`arm_segments`).

    Curvatures are positive where the plastic is outside: with the plastic up, the sheet's edges go down. Energies are
    per printed area, relative to the flat relaxed cell. "Natural" means the tube on which the moment vanishes; where
    that is hardly curved (`natural_curvature.MIN_NATURAL_CURL`), stretches, relief and membrane are those of a tube of
    little curvature. The mean surface is that of all points of the fabric, weighted by printed area. D directions,
    angles counterclockwise from the print's y axis to the printed direction that runs around the tube.

    Attributes
    ----------
    length_mm, thickness_mm, width_mm, stretch, edge_mm, spacing_mm, vertices : what was solved; the stretch along x.
    segments, segment_weights : mesh edges of an arm, and the weight of each.
    meshes_apart : by what part of the larger their natural curvatures (means over the directions) differ, 2 for
        opposite ones; 0 where neither curls. None with one mesh.
    failed : None, or in one line why there are no (or not all) numbers.
    rest_metric : (2, 2) `F^T F` of the flat relaxed cell in print coordinates; lam = sqrt(det F).
    membrane : (3, 3) N/mm, tangent at the flat relaxed cell, Voigt (E11, E22, 2 E12) of `E = (a - a_r)/2`.
    anisotropy : distance of the membrane's and of the bending's tangent, each over its own size, from the nearest
        isotropic one, the larger of both.
    angles_rad : (D,).
    natural_curvature : (D,) 1/mm of the contracted sheet, one over the mean surface's radius.
    natural_print_curvature : (D,) 1/mm, angle around the tube per printed length; the above times the hoop stretch.
    natural_energy : (D,) N/mm.
    natural_hoop, natural_axial : (D,) stretches of the mean surface on the natural tube.
    natural_membrane : (D, 3, 3) N/mm, tangent on the natural tube, see `homogenize.cell.tube_membrane`.
    relief : (2, W), amplitudes of the waves of the star's heights over the mean surface, see `corrugation_waves`:
        mm on the flat cell, and mm^2, by how much more per curvature of the contracted sheet on the natural tubes (mean
        of the directions).
    bending : (D,) N mm, `D = 2 (psi_0 - psi_c)/kappa_c^2`; with a slight curvature only, the tangent by kappa.
    sixfold : N mm^2, `c3 = 4 (psi_0 - psi_30)/kappa_c^3`, of the natural energies at 0 and 30 degrees and their mean
        curvature; 0 without natural curvature, and for stars without threefold symmetry.
    curve_curvature, curve_energy, curve_moment, curve_hoop : per direction, all tubes solved by growing curvature:
        1/mm of the print, N/mm, N (derivative by the print's curvature) and the hoop stretch.
    stiffness : (6, 6) `[A B; B^T D]` of strain and curvature of the mean surface, see `effective_stiffness`.
    rest_curvature : (3,) 1/mm, Voigt curvature b_r at which the linear response has no moment.
    moment : (3,) N, of the flat relaxed cell, conjugate to the Voigt curvature.
    centre_offset_mm : star centre over the mean surface, flat; natural_centre_offset_mm : (D,) on the natural tube.
    bump_mm : star centre over its tips, flat; natural_bump_mm : (D,).
    eigenvalue, eigenvalue_error : N/mm, smallest of the flat cell's Hessian; supercell_eigenvalue of the 2 x 2 one;
        natural_eigenvalue, natural_supercell_eigenvalue : (D,), of the natural tubes.
    down_energy : N/mm, of the flat cell with its star down; None if there is one flat equilibrium only (`bump_mm` may
        then be negative; `natural_bump_mm` says on which side the star is where it matters).
    iterations : Newton's, of all solves; seconds : wall time by part.
    """

    length_mm: float
    thickness_mm: float
    width_mm: float
    stretch: float
    edge_mm: float
    spacing_mm: float
    vertices: int
    segments: Array
    segment_weights: Array
    meshes_apart: float | None = None
    failed: str | None = None
    rest_metric: Array | None = None
    lam: float | None = None
    membrane: Array | None = None
    anisotropy: float | None = None
    angles_rad: Array | None = None
    natural_curvature: Array | None = None
    natural_print_curvature: Array | None = None
    natural_energy: Array | None = None
    natural_hoop: Array | None = None
    natural_axial: Array | None = None
    natural_membrane: Array | None = None
    relief: Array | None = None
    bending: Array | None = None
    sixfold: float | None = None
    curve_curvature: list[Array] | None = None
    curve_energy: list[Array] | None = None
    curve_moment: list[Array] | None = None
    curve_hoop: list[Array] | None = None
    stiffness: Array | None = None
    rest_curvature: Array | None = None
    moment: Array | None = None
    centre_offset_mm: float | None = None
    natural_centre_offset_mm: Array | None = None
    bump_mm: float | None = None
    natural_bump_mm: Array | None = None
    eigenvalue: float | None = None
    eigenvalue_error: float | None = None
    supercell_eigenvalue: float | None = None
    supercell_eigenvalue_error: float | None = None
    natural_eigenvalue: Array | None = None
    natural_supercell_eigenvalue: Array | None = None
    down_energy: float | None = None
    iterations: int = 0
    seconds: dict[str, float] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {name: _plain(getattr(self, name)) for name in (entry.name for entry in fields(self))}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """A sample from plain data."""
        return cls(**{name: _arrays(name, value) for name, value in data.items()})


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [one.tolist() for one in value] if isinstance(value, list) else value


def _arrays(name: str, value: Any) -> Any:
    if not isinstance(value, list):
        return value
    return [np.array(one) for one in value] if name.startswith("curve_") else np.array(value)


def solve_cell(design: Design, edge_mm: float, angles: tuple[float, ...] | None = None) -> Sample:
    """Solve the cell of the design's star; what cannot be solved is said in `failed`.

    `angles`: of the tubes, rad; by default those that a law needs (`tube_directions`), for fabric that is
    stretched alike in x and y. `sixfold` compares the first with the last.

    Raises
    ------
    ValueError
        The design has no cell: its stars are not equal, or gravity is on. Or an edge or angles that are none.
    DesignError, MeshError
        Its arms overlap, no mesh follows them, or no angles go with its stretch.
    """
    if not 0.0 < edge_mm < math.inf:
        raise ValueError(f"edge_mm = {edge_mm}: must be above 0")
    if angles is not None and not (len(angles) and np.isfinite(angles).all()):
        raise ValueError(f"angles = {angles}: must be one at least, and finite")
    clock = Clock()
    sx, sy = design.fabric.stretch_xy
    if angles is None and sx != sy:
        raise DesignError("fabric.stretch", "must be one number where no angles are given", [sx, sy])
    angles = tube_angles(design.lattice) if angles is None else angles
    cuts = arm_segments(design, edge_mm)
    each: list[dict[str, Any]] = []
    for segments, _ in cuts:
        cell: UnitCell = clock("mesh and model", UnitCell, design, edge_mm, (1, 1), segments)
        found: dict[str, Any] = {"angles_rad": np.array(angles), "iterations": 0}
        try:
            _measure(clock, cell, angles, found)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            found = {"failed": str(error), "iterations": found["iterations"]}
        finally:
            cell.close()
        each.append(found)
    weights = np.array([weight for _, weight in cuts])
    return Sample(
        length_mm=star_size(design, "length_mm"),
        thickness_mm=star_size(design, "thickness_mm"),
        width_mm=star_size(design, "width_mm"),
        stretch=sx,
        edge_mm=edge_mm,
        spacing_mm=cell.spacing,
        vertices=cell.mesh.n_base,
        segments=np.array([segments for segments, _ in cuts]),
        segment_weights=weights,
        meshes_apart=_apart(each, cell.spacing),
        seconds=clock.seconds,
        **blend_responses(each, weights),
    )


def _apart(each: list[dict[str, Any]], spacing: float) -> float | None:
    """What `Sample.meshes_apart` says of the responses of two meshes."""
    if len(each) < 2 or any("failed" in found for found in each):
        return None
    kappa = [float(np.mean(found["natural_curvature"])) for found in each]
    largest = float(np.abs(kappa).max())
    return 0.0 if largest * spacing < MIN_RESOLVED_CURL else float(np.ptp(kappa)) / largest


def _measure(clock: Clock, cell: UnitCell, angles: tuple[float, ...], found: dict[str, Any]) -> None:
    flat: FlatCell
    flat, other = clock("flat", relax_flat_cell, cell)
    found["rest_metric"] = flat.deformation @ flat.deformation
    found["lam"] = flat.stretch
    found["bump_mm"] = float(flat.bump[0])
    linear: EffectiveStiffness = clock("stiffness", effective_stiffness, cell, flat)
    found["stiffness"], found["membrane"] = linear.stiffness, linear.stiffness[:3, :3]
    found["moment"], found["rest_curvature"] = linear.moment, linear.rest_curvature
    found["anisotropy"] = max(
        distance_from_isotropy(linear.stiffness[:3, :3]), distance_from_isotropy(linear.stiffness[3:, 3:])
    )
    found["centre_offset_mm"] = -mean_height(cell, flat.state)
    found["iterations"] = flat.iterations
    own: CellStability = clock("stability", cell_stability, cell, flat.state)
    found["eigenvalue"], found["eigenvalue_error"] = own.cell, own.cell_error
    found["supercell_eigenvalue"], found["supercell_eigenvalue_error"] = own.supercell, own.supercell_error
    if other is not None:
        found["down_energy"] = other.energy - flat.energy
    curves: list[TubeBranch] = []
    sx, sy = cell.design.fabric.stretch_xy
    threefold = is_threefold(cell.design.lattice)
    alike = sx == sy and threefold  # else the next direction's natural tube may be another form
    for angle in angles:
        curves.append(clock("tubes", trace_tubes, cell, flat, angle, curves[-1] if alike and curves else None))
        found["iterations"] += sum(tube.iterations for tube in curves[-1].tubes)
    found |= _bending(flat, curves, threefold)
    ends = [curve.natural or curve.tubes[0] for curve in curves]
    offsets = np.array([centre_offset(cell, tube) for tube in ends])
    part = np.array([curve.slight / curve.tubes[0].curvature for curve in curves])
    between = found["centre_offset_mm"] + part * (offsets - found["centre_offset_mm"])
    found["natural_centre_offset_mm"] = np.where([curve.natural is None for curve in curves], between, offsets)
    found["natural_membrane"] = np.array([clock("stiffness", tube_membrane_stiffness, cell, tube) for tube in ends])
    found["relief"] = _relief(cell, flat, ends)
    lowest = [clock("stability", _tube_stability, cell, tube) for tube in ends]
    found["natural_eigenvalue"] = np.array([one.cell for one in lowest])
    found["natural_supercell_eigenvalue"] = np.array([one.supercell for one in lowest])


def _relief(cell: UnitCell, flat: FlatCell, tubes: list[Tube]) -> Array:
    """(2, W) mm and mm^2, on the flat cell and more by curvature."""
    waves = CorrugationWaves.of(cell.design.lattice)
    n, star = cell.mesh.n_base, cell.mesh.star_vertices[0]
    offsets = cell.printed[:n] - cell.printed[star]
    lying = waves.amplitudes(offsets, flat.state.positions[:n, 2], cell.weights)
    rolled = waves.amplitudes(
        offsets, np.mean([heights_over_mean_surface(cell, tube) for tube in tubes], axis=0), cell.weights
    )
    return np.array([lying, (rolled - lying) / np.mean([tube.contracted_curvature for tube in tubes])])


def _tube_stability(cell: UnitCell, tube: Tube) -> CellStability:
    cell.set_tube(tube.curvature, tube.angle)
    return cell_stability(cell, tube.state)


def _bending(flat: FlatCell, curves: list[TubeBranch], threefold: bool) -> dict[str, Any]:
    """What the tubes say; `threefold`: of stars and a lattice that repeat after a third of a turn."""
    ends = [curve.natural or curve.tubes[0] for curve in curves]
    hoop = np.array([tube.hoop for tube in ends])
    printed = np.array([curve.natural.curvature if curve.natural else curve.slight for curve in curves])
    curvature = printed / hoop
    energy = np.array(
        [
            curve.natural.energy - flat.energy if curve.natural else -0.5 * curve.stiffness * curve.slight**2
            for curve in curves
        ]
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        secant = -2.0 * energy / curvature**2
    tangent = np.array([curve.stiffness for curve in curves]) * hoop**2
    bending = np.where([curve.natural is None for curve in curves], tangent, secant)
    mean = 0.5 * (curvature[0] + curvature[-1])
    sixfold = float(4.0 * (energy[0] - energy[-1]) / mean**3) if threefold and mean else 0.0
    ordered = [curve.tubes for curve in curves]
    return {
        "natural_curvature": curvature,
        "natural_print_curvature": printed,
        "natural_energy": energy,
        "natural_hoop": hoop,
        "natural_axial": np.array([tube.axial for tube in ends]),
        "natural_bump_mm": np.array([tube.bump[0] for tube in ends]),
        "bending": bending,
        "sixfold": sixfold,
        "curve_curvature": [np.array([tube.curvature for tube in tubes]) for tubes in ordered],
        "curve_energy": [np.array([tube.energy for tube in tubes]) - flat.energy for tubes in ordered],
        "curve_moment": [np.array([tube.moment for tube in tubes]) for tubes in ordered],
        "curve_hoop": [np.array([tube.hoop for tube in tubes]) for tubes in ordered],
    }
