"""All constants of the preview model, each with its unit, its meaning and where its value comes from.

The law of the unit cells holds for an endless sheet of equal stars. A real sheet has a rim, supports and stars that
change from place to place. The parts of the model describe these (`PARTS`); the modules of this package state their
equations. Tolerances, iteration limits and mesh sizes are no model: they stand in the files that use them.

Lengths without a unit of their own are counted in spacings of the stars, and ratios have no unit.

Examples
--------
A preview without the curl of free rims:

>>> "arms into free rims" in without("arms into free rims").parts
False
"""

from __future__ import annotations

from dataclasses import dataclass, replace

# corrections of the fields (`fields/sheet_fields.py`), and parts of the shape that is shown
PARTS = (
    "rosette metric", "directions", "roll axis", "arms into free rims", "Gaussian curvature", "softness at points",
    "neo-Hookean fabric", "bumps", "arms that keep their length",
)  # fmt: skip
# constants fitted to sheets, so that previews come close to exact shapes: python -m benchmarks.fit_constants FOLDER
FITTED = ("anisotropy_share", "sixfold_factor", "gaussian_area", "smoothing_per_arm", "rim_arm_among")


@dataclass(frozen=True)
class PreviewModel:
    """Constants and switches of the preview.

    A preview takes another model as `Preview(design, model=replace(PREVIEW_MODEL, ...))`. Constants are not checked.
    """

    # the parts that act
    parts: tuple[str, ...] = PARTS

    # stars that are not the same in all directions: fields/directional.py
    # share of the cells' difference between directions that acts in sheets; fitted, a choice among shares: 18 free
    # sheets of four to six arms or on a square lattice
    anisotropy_share: float = 0.7
    # roll axis, the sixfold term: fields/roll_axis.py, fields/star_values.py
    # sixfold term of sheets over that of cells; fitted: fig8-l-increasing, fig8-l-decreasing, random-39; tube
    sixfold_factor: float = 1.4
    # saturation curvature of the sixfold term over the natural one; origin unknown
    sixfold_saturation: float = 3.0
    # share of the bending stiffness that the sixfold term may take away in one direction: cells of the paper's material
    # stay below
    max_sixfold_share: float = 0.7
    # Gaussian curvature works against the stress within cells: fields/self_stress.py
    # area of the Gaussian modulus, in squared spacings; fitted: ribbons and free caps. Flat sheets give 1/100 to 1/59
    gaussian_area: float = 1.0 / 60.0
    # the metric where stars change: fields/rosette.py
    # how far back along an arm its star is: half way to the next one
    arm_setback: float = 0.5
    # an arm is a last one if the next star is further away by this; origin unknown
    last_arm_margin: float = 0.3
    # smoothed cells: fields/star_cells.py
    # width of the Gaussian over the length of the arms; fitted: random-10, random-04, random-44, fig8-h-increasing
    smoothing_per_arm: float = 0.4
    # a bump ends here: the corners of a cell of the triangular lattice
    cell_radius: float = 3.0**-0.5
    # supported points: point_pins.py. All follow from wedges of bare fabric, as in
    # pytest tests/asterism/previews/test_point_pins.py
    # radius of the softer spot at a pin, in edges of the shell
    point_spot_radius: float = 0.35
    # angles of the sheet at a pin in degrees, for both tables
    point_angles_deg: tuple[float, ...] = (45.0, 60.0, 90.0, 120.0, 150.0, 180.0, 270.0, 360.0)
    # d - c: what the shell's vertex lacks in compliance
    point_lack: tuple[float, ...] = (2.90, 2.81, 2.53, 1.71, 1.48, 1.38, 0.97, 0.86)
    # g: compliance that a softness of one adds
    point_gain: tuple[float, ...] = (2.82, 2.67, 2.30, 1.49, 1.14, 0.93, 0.59, 0.74)
    # free sides: fields/free_sides.py
    # a side is supported by points nearer to it than this; origin unknown
    rim_pin_distance: float = 0.5
    # arms that point into a free rim: fields/rim_arms.py
    # border distance at which an arm carries none: no room ahead
    rim_arm_start: float = 0.5
    # border distance at which it carries all: room for a whole cell
    rim_arm_full: float = 1.5
    # share that an arm carries that leads to another star; fitted: 42 free sheets; 100x40, 100x85, tube
    rim_arm_among: float = 0.2
    # bumps: bumps.py
    # turn over a spacing, in rad, in which bumps come most of the way from flat to natural: cells of long thin stars
    bump_turn_rad: float = 0.55
    # strain over the flat cell at which half of a bump is left: a fit to bumps of seven equal stars on held borders
    bump_strain: float = 0.045
    # arms as rods: arms.py. Both distances follow from flat cells, as in pytest tests/asterism/previews/test_arms.py
    # distance beside an arm in which the fabric follows it
    fabric_beside_arm: float = 0.15
    # distance beyond a tip in which the fabric follows it
    fabric_beyond_tip: float = 0.25
    # share of the distance to a support that a tip moves at most; origin unknown
    arm_support_share: float = 0.25


PREVIEW_MODEL = PreviewModel()


def without(part: str) -> PreviewModel:
    """The model with one part turned off.

    Raises
    ------
    KeyError
        `PARTS` has no part of that name.

    Examples
    --------
    >>> "roll axis" in without("roll axis").parts
    False
    """
    if part not in PARTS:
        raise KeyError(part)
    return replace(PREVIEW_MODEL, parts=tuple(each for each in PARTS if each != part))
