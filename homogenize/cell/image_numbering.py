"""Numbers of unfolded points: the base points of a cell first, then their images in the order of use."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Ints


class ImageNumbering:
    """Numbers of the points that the elements of a periodic mesh use."""

    def __init__(self, n_base: int) -> None:
        self._n_base = n_base
        self._images: dict[tuple[int, int, int], int] = {}

    def __call__(self, point: Ints, first: Ints, second: Ints) -> Ints:
        """(N,) numbers of the images of base points (N,), so many cell vectors A1 and A2 away."""
        out = np.empty(len(point), dtype=np.int64)
        for place, (p, a, b) in enumerate(zip(point, first, second, strict=True)):
            if a == 0 and b == 0:
                out[place] = p
            else:
                key = (int(p), int(a), int(b))
                out[place] = self._images.setdefault(key, self._n_base + len(self._images))
        return out

    def unfolded(self) -> tuple[Ints, Ints]:
        """Base point (U,) and image (U, 2) of all numbered points."""
        own = np.arange(self._n_base)
        images = np.array(list(self._images), dtype=np.int64).reshape(-1, 3)
        base = np.concatenate([own, images[:, 0]])
        return base, np.concatenate([np.zeros((len(own), 2), dtype=np.int64), images[:, 1:]])


def new_triangles(some: Ints, known: Ints) -> Ints:
    """The triangles (n, 3) of `some` that are not among the known ones, each once."""
    every = np.concatenate([known, some])
    first = np.unique(np.sort(every, axis=1), axis=0, return_index=True)[1]
    return every[np.sort(first[first >= len(known)])]
