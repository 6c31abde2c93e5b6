"""Types of the arrays that all packages exchange."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]
# floats, or complex numbers where derivatives come from complex steps
Array = NDArray[Any]
