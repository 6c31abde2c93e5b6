"""The designs of a sweep: all combinations of listed values, or a Latin hypercube."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from asterism.sweeps.parameters import SweepError, SweepParameter

# designs of one sweep: the page with their pictures stays below 200 MB
MAX_POINTS = 10_000


def grid(parameters: Sequence[SweepParameter]) -> list[dict[str, Any]]:
    """All combinations, by path; the last parameter varies fastest.

    Raises
    ------
    SweepError
        A parameter is a range without a number of values, or there are more than `MAX_POINTS` combinations.

    Examples
    --------
    >>> grid([SweepParameter("a", (1, 2)), SweepParameter("b", (3, 4))])
    [{'a': 1, 'b': 3}, {'a': 1, 'b': 4}, {'a': 2, 'b': 3}, {'a': 2, 'b': 4}]
    """
    for each in parameters:
        if each.limits is not None:
            low, high = each.limits
            problem = "a range needs a number of values, FROM:TO:COUNT, or --samples for a Latin hypercube"
            raise SweepError(f"{each.path}={low:g}:{high:g}: {problem}")
    count = math.prod(len(each.values) for each in parameters)
    if count > MAX_POINTS:
        raise SweepError(f"{count} designs: must be at most {MAX_POINTS}; --samples takes some of the combinations")
    return [
        dict(zip((each.path for each in parameters), row, strict=True))
        for row in product(*(p.values for p in parameters))
    ]


def latin_hypercube(parameters: Sequence[SweepParameter], samples: int, seed: int) -> list[dict[str, Any]]:
    """So many designs, spread evenly over each parameter: in each of `samples` equal parts of a range lies one value.

    Reference: McKay, Beckman and Conover, A comparison of three methods for selecting values of input variables in the
    analysis of output from a computer code, 1979.

    Raises
    ------
    SweepError
        The number of samples is out of range.
    """
    if not 2 <= samples <= MAX_POINTS:
        raise SweepError(f"--samples {samples}: must be from 2 to {MAX_POINTS}")
    from scipy.stats import qmc  # takes half a second to import

    parts = qmc.LatinHypercube(d=len(parameters), seed=np.random.default_rng(seed)).random(samples)
    return [{each.path: each.at(float(part)) for each, part in zip(parameters, row, strict=True)} for row in parts]
