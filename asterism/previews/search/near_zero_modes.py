"""Near-zero modes of an equilibrium: motions of the sheet that cost little energy.

A mode with the eigenvalue `s_i` (N/mm^3) of the Hessian against the printed area A would take the energy E at stake
(`fem.search.evidence`) up to this amplitude, rms over the sheet, in % of its diameter D:

    a_i = 100/D sqrt(2 E / (s_i A)).

One near-zero mode is common: the rotation of a tube's axis. A sheet with two near-zero modes may rest in another form.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.evidence import ShellEquilibrium
from asterism.fem.shell.shell import Shell

# smaller and negative eigenvalues are replaced by this one
MIN_STIFFNESS_N_MM3 = 1e-12
# % of the diameter: with a larger second amplitude the search tries further initial guesses; chosen by hand
SECOND_AMPLITUDE_PERCENT = 18.0


def amplitudes_percent(stiffness: Floats, energy: float, area: float, diameter: float) -> Floats:
    """(k,) amplitudes a_i of the formula above, the largest first.

    Parameters
    ----------
    stiffness : (k,) N/mm^3, smallest eigenvalues of the Hessian against the printed area.
    energy, area, diameter : E, A and D in N mm, mm^2 and mm.

    Examples
    --------
    >>> amplitudes_percent(np.array([0.01, 0.04]), energy=2.0, area=100.0, diameter=100.0).round(3).tolist()
    [2.0, 1.0]
    """
    safe = np.maximum(np.asarray(stiffness, dtype=float), MIN_STIFFNESS_N_MM3)
    return np.sort(100.0 / diameter * np.sqrt(2.0 * max(energy, 0.0) / (safe * area)))[::-1]


def has_two_near_zero_modes(amplitudes: Floats, percent: float = SECOND_AMPLITUDE_PERCENT) -> bool:
    """Whether the second of the amplitudes (k,), in % of the diameter, is above a limit.

    Examples
    --------
    The rotation of a tube's axis is one near-zero mode:

    >>> has_two_near_zero_modes(np.array([80.0, 10.0]))
    False
    """
    return len(amplitudes) > 1 and bool(amplitudes[1] > percent)


def is_equilibrium_near_another(
    shell: Shell, equilibrium: ShellEquilibrium, size: float, percent: float = SECOND_AMPLITUDE_PERCENT
) -> bool:
    """Whether a sheet with a diameter of about `size` mm has two modes with amplitudes above `percent`."""
    area = float(shell.assembly.weights.sum())
    amplitudes = amplitudes_percent(equilibrium.soft_modes, equilibrium.absolute_energy, area, size)
    return has_two_near_zero_modes(amplitudes, percent)
