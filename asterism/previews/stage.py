"""The stages of an edit of a preview."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from asterism.equilibrium.arrays import Floats


@dataclass(frozen=True)
class Stage:
    """A result of an edit.

    Attributes
    ----------
    name : `linear`, the linear response of the last equilibrium to the edit; or `equilibrium`.
    x : (N, 3) degrees of freedom of the shell; a copy.
    """

    name: Literal["linear", "equilibrium"]
    x: Floats
