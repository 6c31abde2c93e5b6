"""Colours of a distance, from light (zero) to dark, without a plotting library.

The colours are every sixteenth entry of the colour map magma, reversed, of S. van der Walt and N. Smith, who gave it to
the public domain (CC0); between them they are linear, and differ from the map by at most 1.4 %.
"""

from __future__ import annotations

import numpy as np

from equilibrium.arrays import Array, Floats

# red, green and blue from 0 to 255, at equal distances from the lowest value to the highest
MAGMA_RGB = (
    (252, 253, 191), (253, 224, 161), (254, 194, 135), (254, 165, 113), (251, 135, 97), (244, 105, 92),
    (229, 80, 100), (207, 64, 112), (181, 54, 122), (155, 46, 127), (129, 37, 129), (104, 28, 129),
    (79, 18, 123), (52, 16, 105), (28, 16, 68), (9, 7, 32), (0, 0, 4),
)  # fmt: skip


def magma(shares: Array) -> Floats:
    """(..., 3) red, green and blue from 0 to 1 of shares (...) from 0 to 1 of the largest value.

    Examples
    --------
    >>> (255 * magma(np.array([0.0, 1.0]))).round().tolist()
    [[252.0, 253.0, 191.0], [0.0, 0.0, 4.0]]
    """
    stops = np.linspace(0.0, 1.0, len(MAGMA_RGB))
    table = np.array(MAGMA_RGB) / 255.0
    return np.stack([np.interp(shares, stops, table[:, channel]) for channel in range(3)], axis=-1)


def magma_hex(share: float) -> str:
    """The colour of a share as in HTML.

    >>> magma_hex(0.0)
    '#fcfdbf'
    """
    return "#" + "".join(f"{round(255 * channel):02x}" for channel in magma(np.array(share)))
