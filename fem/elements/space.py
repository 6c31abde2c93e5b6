"""What the shell asks of a discretisation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import scipy.sparse as sp

from fem.elements.tabulation import Floats
from fem.supports import edge_equations

Map = Callable[[Floats], Floats]


class Space(edge_equations.Space, Protocol):
    """Beyond what conditions and loads need."""

    def penalty(self, modulus: Floats | float = 1.0) -> sp.csr_matrix | None:
        """(N, N) quadratic form that holds the functions together where they are not C1, per bending modulus."""

    def interpolate(self, jets: Map) -> Floats:
        """(N, 3) coefficients of a map from (n, 2) to (n, 6, 3), its value and derivatives 1, 2, 11, 22, 12."""
