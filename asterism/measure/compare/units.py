"""Units of a scan: those that are asked for, and those that it seems to be in."""

from __future__ import annotations

import math
from pathlib import Path

from asterism.measure.compare.errors import ScanError

MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "um": 0.001}
_NAMES = {"mm": "millimetres", "cm": "centimetres", "m": "metres", "in": "inches", "um": "micrometres"}
# a scan may be of a part only, or have the table on it
_LIKELY = (0.25, 2.0)


def check_size(file: Path, size_mm: float, expected_mm: float, unit: str | None) -> None:
    """Raise ScanError if a scan's size, taken in `unit`, cannot be that of the shape; names the units that could be.

    Parameters
    ----------
    size_mm : largest extent of the scan, converted to mm.
    expected_mm : of the shape.
    unit : None for a drawing that says its own size.
    """
    own, unit = unit is None, unit or "mm"
    ratio = size_mm / expected_mm
    if _LIKELY[0] <= ratio <= _LIKELY[1]:
        return
    size = f"{size_mm:.4g} mm" if unit == "mm" else f"{size_mm / MM[unit]:.4g} {unit}"
    problem = f"is {size} large, the shape {expected_mm:.4g} mm"
    sizes = {other: size_mm / MM[unit] * MM[other] / expected_mm for other in MM if other != unit}
    likely = sorted(
        (o for o, r in sizes.items() if _LIKELY[0] <= r <= _LIKELY[1]), key=lambda o: abs(math.log(sizes[o]))
    )
    if likely:
        names = " or ".join(_NAMES[other] for other in likely)
        options = "say " + " or ".join(f"--units {other}" for other in likely)
        problem += f": it seems to be in {names}; {'correct its width and height' if own else options}"
    else:
        problem += ", in no known unit the same thing; is it the right scan, without what lies around the sheet?"
    raise ScanError(file, problem)
