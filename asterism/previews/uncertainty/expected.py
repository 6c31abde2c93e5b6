"""How far off a preview expects to be, from what it knows itself.

A shape is uncertain where it is soft. Its softest motions, with the eigenvalues `s_i` (N/mm^3) against the printed area
A, would take the energy E at stake (`fem.search.evidence`) up to these amplitudes, rms over the sheet, in % of its
diameter D:

    a_i = 100/D sqrt(2 E / (s_i A)).

The law's energies are wrong by a small part of E, so that the shape is off by a small part of the amplitudes. How small
was found by comparing previews with the exact model over many designs (`python -m benchmarks.accuracy.expectation`):

- the mean square of the distance is `FLOOR^2 + (share a)^2`, a being the amplitude of all soft motions together;
- the share is .04 for free sheets without symmetry, and less for held ones, which are not pushed far, and for those
  that a turn maps to themselves: errors of the law have the symmetry of the design, and do not push along motions that
  break it, such as the turn of the axis of a roll. A mirror alone leaves the softest motions free: it is .06 for such
  sheets, which mostly are rectangles, whose rims are bare by different widths;
- a sheet with two soft motions may rest in another form altogether; a held one, whose edges and corners alone are free,
  with motions that are less soft;
- no smooth sheet is like one whose stars curl tighter than their spacing: free ones add ANOTHER_FORM times their part;
- a free sheet of unequal stars adds CONTRAST times how far it would go if contractions were wrong by as much as sizes
  differ (`asterism.previews.uncertainty.contrast`), and at most what another form is worth;
- a sheet that is held much narrower than it would be buckles, and where its dents go the law cannot tell: it adds
  BUCKLED, less between the two ratios of NARROWER.

A minimum that the preview met besides the one it shows (`other_forms`) may be the right one. The law's energies are
uncertain by a part UNSURE of E, taken as normally distributed; so a form that is a part g of E higher and d % away is
the lower one with the probability `P = erfc(g/(sqrt(2) UNSURE))/2`. To the square of the distance the largest is added
of all `P d^2` and of what two soft ways are worth.

docs/explanation/accuracy.md shows how good this is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from asterism.previews.uncertainty.other_forms import OtherForm
from pattern.geometry.arrays import Floats
from pattern.layout.symmetries import Symmetry

# the distance in % for an amplitude a in %: FLOOR and a share of a; for free sheets without symmetry, those that have a
# mirror alone, and the others
FLOOR, SHARE, MIRRORED, FORGIVEN = 0.3, 0.04, 0.06, 0.03
# second amplitude in % from which another form is near, of free sheets and of held ones; how sharply, and the distance
# in % that is added then
TWO_WAYS, HELD_TWO_WAYS, SHARPNESS, ANOTHER_FORM = 20.0, 13.0, 8.0, 5.0
# part of the deviation of a star's size from the mean by which its contraction may be wrong
CONTRAST = 0.1
# distance in % that is added where a sheet is held as narrow, over its own width, as the second of these, and from the
# first one on none
BUCKLED, NARROWER = 2.5, (0.93, 0.87)
# part of the energy by which two forms may differ and the lower one yet be the other
UNSURE = 0.1


def amplitudes_percent(soft_modes: Floats, energy: float, area: float, diameter: float) -> Floats:
    """(k,) a_i above, the largest first.

    Parameters
    ----------
    soft_modes : (k,) N/mm^3, smallest eigenvalues against the printed area.
    energy, area, diameter : N mm, mm^2 and mm.
    """
    safe = np.maximum(np.asarray(soft_modes, dtype=float), 1e-12)
    return np.sort(100.0 / diameter * np.sqrt(2.0 * max(energy, 0.0) / (safe * area)))[::-1]


def expected_rms_percent(
    amplitudes: Floats,
    others: Sequence[OtherForm] = (),
    share: float = SHARE,
    held: bool = False,
    tight: float = 0.0,
    width: float = 1.0,
    contrast: float = 0.0,
) -> float | None:
    """The distance to the exact model to be expected, in % of the diameter; None without two amplitudes.

    `share`: see `share_of`; `tight`: part of the stars; `width` at which the sheet is held, over its own; `contrast`:
    % of the diameter. Over many designs it is a root mean square: most are nearer.
    """
    if len(amplitudes) < 2:
        return None
    curled = 0.0 if held else ANOTHER_FORM * tight
    soft = share * float(np.linalg.norm(amplitudes))
    near = math.hypot(FLOOR, soft, curled, BUCKLED * buckling(width), of_unequal_stars(contrast))
    ratio = (float(amplitudes[1]) / _two_ways(held)) ** SHARPNESS
    form = max(
        [ANOTHER_FORM * ratio / (1.0 + ratio), *(math.sqrt(_chance(o.gap)) * o.distance_percent for o in others)]
    )
    return float(np.hypot(near, form))


def share_of(held: bool, symmetries: Sequence[Symmetry]) -> float:
    """The share of the amplitudes that the law's errors push a sheet with these symmetries, the identity among them."""
    if held or sum(not symmetry.mirrors for symmetry in symmetries) > 1:
        return FORGIVEN
    return MIRRORED if len(symmetries) > 1 else SHARE


def of_unequal_stars(contrast: float) -> float:
    """%, by which a free sheet's contrast in % takes it away; where it is about to fold, to another form at most."""
    return min(CONTRAST * contrast, ANOTHER_FORM)


def buckling(width: float) -> float:
    """From 0 to 1, how surely a sheet that is held at such a width, over its own, buckles in one of several ways."""
    wide, narrow = NARROWER
    return min(max((wide - width) / (wide - narrow), 0.0), 1.0)


def close_form(others: Sequence[OtherForm]) -> OtherForm | None:
    """The form that the sheet might as well rest in: the lowest other one, if the law cannot tell which is lower."""
    return next((form for form in others if form.gap < UNSURE), None)


def _chance(gap: float) -> float:
    """That a form whose energy is a part `gap` higher is the lower one."""
    return 0.5 * math.erfc(gap / (math.sqrt(2.0) * UNSURE))


def another_form_is_near(amplitudes: Floats, held: bool = False) -> bool:
    """Whether the sheet is soft in two ways."""
    return len(amplitudes) > 1 and bool(amplitudes[1] > _two_ways(held))


def _two_ways(held: bool) -> float:
    return HELD_TWO_WAYS if held else TWO_WAYS
