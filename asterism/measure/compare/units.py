"""Units of a scan: the unit in use, and units that would fit the size of the shape."""

from __future__ import annotations

import math
from pathlib import Path

from asterism.measure.compare.errors import ScanError

MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "um": 0.001}
_NAMES = {"mm": "millimetres", "cm": "centimetres", "m": "metres", "in": "inches", "um": "micrometres"}


def check_size(file: Path, size_mm: float, expected_mm: float, unit: str | None) -> None:
    """Raise ScanError if the size of a scan cannot be that of the shape; the message names units that fit.

    Parameters
    ----------
    size_mm : largest extent of the scan, converted from `unit` to mm.
    expected_mm : largest extent of the shape.
    unit : unit of the scan's numbers; None for a drawing that gives its size.
    """
    own, unit = unit is None, unit or "mm"
    ratios = {other: size_mm / expected_mm * MM[other] / MM[unit] for other in MM}
    # a scan may show a part, or the table too
    likely = [other for other in sorted(MM, key=lambda o: abs(math.log(ratios[o]))) if 0.25 <= ratios[other] <= 2.0]
    if unit in likely:
        return
    problem = f"is {size_mm / MM[unit]:.4g} {unit} large, the shape {expected_mm:.4g} mm"
    if likely:
        names = " or ".join(_NAMES[other] for other in likely)
        options = "use " + " or ".join(f"--units {other}" for other in likely)
        problem += f": it seems to be in {names}; {'correct its width and height' if own else options}"
    else:
        problem += ", and no known unit fits; is it the right scan, without other objects around the sheet?"
    raise ScanError(file, problem)
