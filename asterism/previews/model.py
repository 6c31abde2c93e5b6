"""All constants of the preview model, each with its unit, its meaning and where its value comes from.

The law of the unit cells holds for an endless sheet of equal stars. A real sheet has a rim, supports and stars that
change from place to place. The parts of the model describe these (`PARTS`); the modules of this package state their
equations. Tolerances, iteration limits and mesh sizes are no model: they stand in the files that use them.

Lengths without a unit of their own are counted in spacings of the stars.

Examples
--------
A preview without the curl of free rims, and the origin of a constant:

>>> "arms into free rims" in without("arms into free rims").parts
False
>>> describe("rim_arm_among").origin
'fitted to sheets'
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal

Origin = Literal["derived", "computed from cells", "computed from sheets", "fitted to sheets", "unknown"]

STUDY = "python -m benchmarks.fit_constants FOLDER"
POINT_PINS = "pytest tests/asterism/previews/test_point_pins.py"


@dataclass(frozen=True)
class Constant:
    """What is known about a constant of the model.

    Attributes
    ----------
    unit : `-` for ratios.
    meaning : one sentence.
    origin : `derived` from mechanics or geometry; `computed from cells`; `computed from sheets` of the exact model, one
        effect at a time; `fitted to sheets`, so that previews come close to exact shapes; or `unknown`.
    command : that produced the value, or how it was found; empty for what is derived.
    designs : that were used.
    """

    unit: str
    meaning: str
    origin: Origin
    command: str = ""
    designs: str = ""


def _of(default: float | tuple[Any, ...], *about: str) -> Any:
    """A field with this default, described by the entries of `Constant`."""
    return field(default=default, metadata={"about": Constant(*about)})  # type: ignore[arg-type]


def _derived(default: float, unit: str, meaning: str) -> Any:
    return _of(default, unit, meaning, "derived")


def _fitted(default: float, unit: str, meaning: str, designs: str, command: str = STUDY) -> Any:
    return _of(default, unit, meaning, "fitted to sheets", command, designs)


def _unknown(default: float, unit: str, meaning: str) -> Any:
    return _of(default, unit, meaning, "unknown", "origin unknown", "origin unknown")


# corrections of the fields (`fields/sheet_fields.py`), and parts of the shape that is shown
PARTS = (
    "rosette metric", "directions", "roll axis", "arms into free rims", "Gaussian curvature", "softness at points",
    "neo-Hookean fabric", "bumps", "arms that keep their length",
)  # fmt: skip


@dataclass(frozen=True)
class PreviewModel:
    """Constants and switches of the preview; `describe` gives unit, meaning and origin of each.

    A preview takes another model as `Preview(design, model=replace(PREVIEW_MODEL, ...))`. Constants are not checked.
    """

    parts: tuple[str, ...] = _of(PARTS, "-", "the parts that act", "derived")

    # stars that are not the same in all directions: fields/directional.py
    anisotropy_share: float = _fitted(
        0.7, "-", "share of the cells' difference between directions that acts in sheets",
        "18 free sheets of four to six arms or on a square lattice",
        "a choice among shares",
    )  # fmt: skip
    # roll axis, the sixfold term: fields/roll_axis.py, fields/star_values.py
    sixfold_factor: float = _fitted(
        1.4, "-", "sixfold term of sheets over that of cells", "fig8-l-increasing, fig8-l-decreasing, random-39; tube"
    )
    sixfold_saturation: float = _unknown(3.0, "-", "saturation curvature of the sixfold term over the natural one")
    max_sixfold_share: float = _of(
        0.7, "-", "share of the bending stiffness that the sixfold term may take away in one direction",
        "computed from cells", "origin unknown", "cells of the paper's material stay below",
    )  # fmt: skip
    # Gaussian curvature works against the stress within cells: fields/self_stress.py
    gaussian_area: float = _fitted(
        1.0 / 60.0, "-", "area of the Gaussian modulus, in squared spacings; flat sheets give 1/100 to 1/59",
        "ribbons and free caps",
    )  # fmt: skip
    # the metric where stars change: fields/rosette.py
    arm_setback: float = _derived(0.5, "spacing", "how far back along an arm its star is: half way to the next one")
    last_arm_margin: float = _unknown(0.3, "spacing", "an arm is a last one if the next star is further away by this")
    # smoothed cells: fields/star_cells.py
    smoothing_per_arm: float = _fitted(
        0.4, "-", "width of the Gaussian over the length of the arms",
        "random-10, random-04, random-44, fig8-h-increasing",
    )  # fmt: skip
    cell_radius: float = _derived(
        3.0**-0.5, "spacing", "a bump ends here: the corners of a cell of the triangular lattice"
    )  # fmt: skip
    # supported points: point_pins.py
    point_spot_radius: float = _of(
        0.35, "shell edge", "radius of the softer spot at a pin", "computed from sheets",
        POINT_PINS, "wedges of bare fabric",
    )  # fmt: skip
    point_angles_deg: tuple[float, ...] = _of(
        (45.0, 60.0, 90.0, 120.0, 150.0, 180.0, 270.0, 360.0), "deg", "angles of the sheet at a pin, for both tables",
        "computed from sheets", POINT_PINS, "wedges of bare fabric",
    )  # fmt: skip
    point_lack: tuple[float, ...] = _of(
        (2.90, 2.81, 2.53, 1.71, 1.48, 1.38, 0.97, 0.86), "-", "d - c: what the shell's vertex lacks in compliance",
        "computed from sheets", POINT_PINS, "wedges of bare fabric",
    )  # fmt: skip
    point_gain: tuple[float, ...] = _of(
        (2.82, 2.67, 2.30, 1.49, 1.14, 0.93, 0.59, 0.74), "-", "g: compliance that a softness of one adds",
        "computed from sheets", POINT_PINS, "wedges of bare fabric",
    )  # fmt: skip
    # free sides: fields/free_sides.py
    rim_pin_distance: float = _unknown(0.5, "spacing", "a side is supported by points nearer to it than this")
    # arms that point into a free rim: fields/rim_arms.py
    rim_arm_start: float = _derived(0.5, "spacing", "border distance at which an arm carries none: no room ahead")
    rim_arm_full: float = _derived(1.5, "spacing", "border distance at which it carries all: room for a whole cell")
    rim_arm_among: float = _fitted(
        0.2, "-", "share that an arm carries that leads to another star", "42 free sheets; 100x40, 100x85, tube"
    )
    # bumps: bumps.py
    bump_turn_rad: float = _of(
        0.55, "rad", "turn over a spacing in which bumps come most of the way from flat to natural",
        "computed from cells", "origin unknown", "cells of long thin stars",
    )  # fmt: skip
    bump_strain: float = _of(
        0.045, "-", "strain over the flat cell at which half of a bump is left", "computed from sheets",
        "a fit to their bumps", "seven equal stars on held borders",
    )  # fmt: skip
    # arms as rods: arms.py
    fabric_beside_arm: float = _of(
        0.15, "spacing", "distance beside an arm in which the fabric follows it", "computed from cells",
        "pytest tests/asterism/previews/test_arms.py", "flat cells",
    )  # fmt: skip
    fabric_beyond_tip: float = _of(
        0.25, "spacing", "distance beyond a tip in which the fabric follows it", "computed from cells",
        "pytest tests/asterism/previews/test_arms.py", "flat cells",
    )  # fmt: skip
    arm_support_share: float = _unknown(0.25, "-", "share of the distance to a support that a tip moves at most")


PREVIEW_MODEL = PreviewModel()


def describe(name: str) -> Constant:
    """Unit, meaning and origin of a constant of the model.

    Raises
    ------
    KeyError
        The model has no constant of that name.
    """
    return {each.name: each.metadata["about"] for each in fields(PreviewModel)}[name]  # type: ignore[no-any-return]


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
