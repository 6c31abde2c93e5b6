"""Estimated error of a preview: rms distance to the exact shape, in % of the diameter, and error of the height.

The preview is a minimum of an energy that is wrong. Its error is a sum of independent normal errors:

- **Energy.** The energy is uncertain by the share u = `energy_uncertainty` of the energy E at stake, in each mode of
  the sheet. A mode of stiffness k would take the energy E up to the amplitude `a = sqrt(2 E/k)`
  (`asterism.previews.search_minima`). If the energy's error changes by u E over that amplitude, it is a force
  `u E/a`, and moves the mode by `u E/(a k) = u a/2`. So the covariance of the shape is `u^2 E/2` times the inverse of
  the Hessian.
- **Stiffnesses.** Membrane, bending, sixfold term and Gaussian modulus have the relative standard deviation
  s = `stiffness_uncertainty`. With the linear response r_p of the sheet to each
  (`fem.search.linear_response`), they move it by s r_p.
- **Narrow sheets.** Supports that hold a sheet narrower than its natural size, by the share 1 - q of it, let it buckle,
  and the exact sheet may buckle at other places: n (1 - q) with n = `buckling_share`.
- **Other forms.** A minimum that the search met, d away and a share g of the energy higher, is the lower one with the
  probability `P = erfc(g/(sqrt(2) u))/2`, by the same u.

With the error m = `mesh_error_percent` of the exact shape itself, and z = `COVERAGE`,

    error^2 = m^2 + z^2 (u^2/4 sum a_i^2 + s^2 sum r_p^2 + n^2 (1 - q)^2 + max P_j d_j^2).

So nine of ten exact shapes are nearer than estimated. u, s and n are fitted together.

**The height** is from the lowest to the highest point, bumps included. The covariance of the shape gives its error, in
mm, here in % of the height:

- **Energy.** With the compliance c (mm/N) against a pair of unit forces at the two points, the standard deviation is
  `u/2 sqrt(2 E c)`.
- **Stiffnesses.** The linear response to each moves the two points apart; s times that.
- **Narrow sheets.** n (1 - q) of the diameter is a distance in space. A third of its variance is along the height.
- **The lowest point** is often the tip of an arm beside the border. Its error is the distance from there to the smooth
  surface. On nearly flat sheets that is much of the height.
- **The mesh.** `mesh_error_percent` of the diameter, as in the distance.

Other forms are left out: a warning names them, and most are as high.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.fem.search.linear_response import STIFFNESSES, compliance, rms_of, stiffness_responses
from asterism.fem.search.mean_fields import mean_fields
from asterism.fem.supports.loads import point_load
from asterism.homogenize.cell.tube_directions import is_threefold, omitted_anisotropy
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.free_motions import count_free_tilts
from asterism.previews.law_warnings import pleat_warning
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.other_forms import OtherForm, close_form, other_forms
from asterism.previews.search_minima import amplitudes_percent
from asterism.previews.state import AnyPreviewState, StarState
from asterism.shape.shape import Shape


@dataclass(frozen=True)
class ErrorSources:
    """Distances are rms over the sheet, in % of the diameter.

    Attributes
    ----------
    diameter_mm : of the shape.
    amplitudes_percent : (k,) of the near-zero modes, the largest first.
    stiffness_percent : (4,) responses per relative error of each of `fem.search.linear_response.STIFFNESSES`.
    size_ratio : size that the supports allow over the natural size; inf unless two points are fixed in all directions.
    other_forms : minima that are not the one shown, the lowest first.
    height : of the height; None without a certain height.
    """

    diameter_mm: float
    amplitudes_percent: Floats
    stiffness_percent: Floats = field(default_factory=lambda: np.zeros(len(STIFFNESSES)))
    size_ratio: float = np.inf
    other_forms: tuple[OtherForm, ...] = ()
    height: HeightDoubts | None = None

    @property
    def narrowing(self) -> float:
        """By how much of the natural size the supports hold the sheet narrower; 0 for other sheets.

        Examples
        --------
        >>> ErrorSources(100.0, np.array([6.0, 4.0]), size_ratio=0.75).narrowing
        0.25
        """
        return max(1.0 - self.size_ratio, 0.0)


def error_sources(state: AnyPreviewState, shape: Shape, up: Floats, clock: Clock) -> ErrorSources:
    """The sources of a state with its near-zero modes; the factor holds the Hessian at its equilibrium.

    Parameters
    ----------
    shape : as it is shown, its height along z.
    up : (3,) unit vector, that direction in the pose of the shell.
    """
    equilibrium, layout, shell = state.equilibrium, state.layout, state.shell
    across, heights, shares = diameter(shape.positions), None, np.zeros(len(STIFFNESSES))
    if equilibrium.is_minimum:
        with clock("expected error"):
            moves = stiffness_responses(shell, equilibrium.x, state.factor)
        shares = 100.0 / across * rms_of(shell, equilibrium.x, moves)
        # supports that let the sheet tilt leave open what counts as its height, unless weight decides
        if state.design.gravity.on or not layout.pins or not count_free_tilts(layout):
            with clock("expected height"):
                heights = height_doubts(state, shape, up, moves)
    ratio = np.inf
    if state.is_supported:
        means = mean_fields(shell)
        ratio = means.chord / means.stretch
    return ErrorSources(
        across,
        amplitudes_percent(equilibrium.soft_modes, equilibrium.absolute_energy, layout.area_mm2, across),
        shares,
        ratio,
        tuple(other_forms(state, across)),
        heights,
    )


@dataclass(frozen=True)
class HeightDoubts:
    """Sources of the error of a height, mm.

    Attributes
    ----------
    height : of the preview.
    lowest : distance of the lowest point from the smooth surface.
    softness : by which the energy at stake would part the lowest and the highest point.
    stiffness : by which they part per relative error of the stiffnesses; root of the sum of squares.
    """

    height: float
    lowest: float
    softness: float
    stiffness: float


def height_doubts(state: AnyPreviewState, shape: Shape, up: Floats, moves: Floats) -> HeightDoubts:
    """Of a state at its equilibrium; the factor holds the exact Hessian there.

    Parameters
    ----------
    shape : the sheet with its bumps, its height along z.
    up : (3,) unit vector, that direction in the pose of the shell.
    moves : (n, 4) mm, linear responses to the stiffnesses, over the free unknowns.
    """
    equilibrium, sheet = state.equilibrium, state.sheet
    height = shape.positions[:, 2]
    ends = [int(height.argmax()), int(height.argmin())]
    forces = point_load(sheet.space, shape.printed[ends], np.array([up, -up]))
    apart = compliance(state.shell, equilibrium.x, state.factor, forces)
    return HeightDoubts(
        height=shape.height_mm,
        lowest=abs(float(shape.point_fields["bump_mm"][ends[1], 2])),
        softness=math.sqrt(2.0 * max(equilibrium.absolute_energy, 0.0) * max(apart, 0.0)),
        stiffness=float(np.linalg.norm(state.shell.restrict(forces) @ moves)),
    )


# standard deviations of a normal error within which nine of ten are
COVERAGE = 1.645


def distance_error_percent(
    sources: ErrorSources, model: PreviewModel = PREVIEW_MODEL, floor_percent: float | None = None
) -> float | None:
    """The estimated error in % of the diameter; None with fewer than two computed modes.

    Parameters
    ----------
    floor_percent : takes the place of the model's mesh error.

    Examples
    --------
    >>> calm = ErrorSources(100.0, np.array([6.0, 4.0, 3.0]))
    >>> narrow = ErrorSources(100.0, np.array([6.0, 4.0, 3.0]), size_ratio=0.8)
    >>> distance_error_percent(narrow) > 5.0 * distance_error_percent(calm)
    True
    """
    if len(sources.amplitudes_percent) < 2:
        return None
    floor = model.mesh_error_percent if floor_percent is None else floor_percent
    return math.hypot(floor, COVERAGE * math.hypot(*distance_parts(sources, model).values()))


def distance_parts(sources: ErrorSources, model: PreviewModel = PREVIEW_MODEL) -> dict[str, float]:
    """Standard deviations in % of the diameter: `soft`, `stiffness`, `narrow` and `form`."""
    forms = [math.sqrt(probability_lower(o.gap, model)) * o.distance_percent for o in sources.other_forms]
    return {
        "soft": 0.5 * model.energy_uncertainty * float(np.linalg.norm(sources.amplitudes_percent)),
        "stiffness": model.stiffness_uncertainty * float(np.linalg.norm(sources.stiffness_percent)),
        "narrow": 100.0 * model.buckling_share * sources.narrowing,
        "form": max(forms, default=0.0),
    }


def probability_lower(gap: float, model: PreviewModel = PREVIEW_MODEL) -> float:
    """Probability that a form whose energy is higher by the share `gap` of the energy at stake is the lower one.

    Examples
    --------
    >>> round(probability_lower(0.0), 2), round(probability_lower(PREVIEW_MODEL.energy_uncertainty), 2)
    (0.5, 0.16)
    """
    return 0.5 * math.erfc(gap / (math.sqrt(2.0) * model.energy_uncertainty))


def height_error_percent(
    sources: ErrorSources, model: PreviewModel = PREVIEW_MODEL, floor_percent: float | None = None
) -> float | None:
    """In % of the height; None for a sheet without a height that is certain. Nine of ten heights are within it.

    Examples
    --------
    >>> import numpy as np
    >>> from asterism.previews.error_estimate import HeightDoubts
    >>> doubts = HeightDoubts(height=20.0, lowest=0.0, softness=0.0, stiffness=0.0)
    >>> height_error_percent(ErrorSources(100.0, np.zeros(2), height=doubts)) == 5.0 * PREVIEW_MODEL.mesh_error_percent
    True
    """
    doubts = sources.height
    if doubts is None or doubts.height <= 0.0:
        return None
    deviations = (
        0.5 * model.energy_uncertainty * doubts.softness,
        model.stiffness_uncertainty * doubts.stiffness,
        model.buckling_share * sources.narrowing * sources.diameter_mm / math.sqrt(3.0),
    )
    floor = model.mesh_error_percent if floor_percent is None else floor_percent
    return (
        100.0
        * math.hypot(0.01 * floor * sources.diameter_mm, doubts.lowest, COVERAGE * math.hypot(*deviations))
        / doubts.height
    )


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated error of a preview, and its sources.

    Attributes
    ----------
    distance_percent : rms distance to the exact shape in % of the diameter, fitted so that nine of ten exact shapes are
        nearer; None if no estimate is available.
    height_percent : error of the height in % of it; None if no estimate is available.
    sources : from which both are computed.
    main_part : the largest contribution to the distance, a key of `distance_parts`.
    close_form : another form that the sheet may rest in as well.
    energy_uncertainty : of the law, as a share of the energy.
    """

    distance_percent: float | None
    height_percent: float | None
    sources: ErrorSources
    main_part: str
    close_form: OtherForm | None
    energy_uncertainty: float

    @classmethod
    def of(
        cls, sources: ErrorSources, model: PreviewModel, is_known: bool, floor_percent: float | None = None
    ) -> ErrorEstimate:
        """The estimate from its sources.

        Parameters
        ----------
        is_known : whether an estimate is available for sheets of this kind.
        floor_percent : as in `distance_error_percent`.
        """
        parts, doubt = distance_parts(sources, model), model.energy_uncertainty
        return cls(
            distance_error_percent(sources, model, floor_percent) if is_known else None,
            height_error_percent(sources, model, floor_percent) if is_known else None,
            sources,
            max(parts, key=lambda name: parts[name]),
            close_form(sources.other_forms, doubt),
            doubt,
        )


# share of the stars: with more of them outside the law, strongly anisotropic or inverted no estimate is available
MAX_FOREIGN_SHARE = 0.1


def estimate_error(state: StarState, shape: Shape, up: Floats, clock: Clock) -> ErrorEstimate:
    """The estimated error of a state with its near-zero modes; arguments as for `error_sources`."""
    return ErrorEstimate.of(error_sources(state, shape, up, clock), state.model, _is_within_experience(state))


def _is_within_experience(state: StarState) -> bool:
    """Whether the estimate holds: it comes from three-armed stars within their law, and holds for stable cells."""
    inverted = int(np.count_nonzero(state.layout.star_branch < 0))
    foreign = max(len(state.values.outside), len(state.values.strongly_anisotropic), inverted)
    lattice = state.design.lattice
    is_turned = is_threefold(lattice) and bool(omitted_anisotropy(lattice))
    is_known = not (is_turned or pleat_warning(state.law))
    return is_known and foreign <= MAX_FOREIGN_SHARE * len(state.layout.centres)
