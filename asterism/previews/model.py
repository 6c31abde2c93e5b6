"""What the preview model consists of: its parts, and the constants that are fitted to sheets.

The law of the unit cells holds for an endless sheet of equal stars. A real sheet has a rim, supports and stars that
change from place to place. The parts of the model describe these; the modules of this package state their equations and
their other constants.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PreviewModel:
    """Parts that do not act, and constants that are fitted to sheets: `python -m benchmarks.fit_constants FOLDER`.

    A preview takes another model as `Preview(design, model=replace(PREVIEW_MODEL, ...))`. Constants are not checked.
    They have no unit; lengths are counted in spacings of the stars.
    """

    off: tuple[str, ...] = ()  # of `fields.sheet_fields.PARTS`, those that are turned off
    # of the cells' difference between directions, that acts in sheets (`sheet_fields.directions`); a choice among
    # shares, on 18 free sheets of four to six arms or on a square lattice
    anisotropy_share: float = 0.7
    # sixfold term of sheets over that of cells (`sheet_fields.roll_axis`); fitted on fig8-l-increasing,
    # fig8-l-decreasing, random-39, tube
    sixfold_factor: float = 1.4
    # of the Gaussian modulus, in squared spacings (`sheet_fields.self_stress`); fitted on ribbons and free caps. Flat
    # sheets give 1/100 to 1/59.
    gaussian_area: float = 1.0 / 60.0
    # width of the Gaussian over the length of the arms (`fields/star_cells.py`); fitted on random-10, random-04,
    # random-44, fig8-h-increasing
    smoothing_per_arm: float = 0.4
    # share that an arm carries into a free rim if it leads to another star (`sheet_fields.rim_arms`); fitted on 42 free
    # sheets; 100x40, 100x85, tube
    rim_arm_among: float = 0.2


PREVIEW_MODEL = PreviewModel()
