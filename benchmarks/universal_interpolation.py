"""Ways to interpolate the scattered cells of the universal law, compared on cells that they have not seen.

    python -m benchmarks.universal_interpolation

Each way is fitted to four fifths of the cells that are spread over the whole range, five times, and tested on the rest.
Kriging, with the same scatter of cells everywhere and with one that varies over the range, is compared with the radial
functions of scipy and with a polynomial chaos of total degree 3. The lengths of kriging scale the coordinates of one of
the radial functions.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from scipy.interpolate import RBFInterpolator

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.law_table import MAX_SEPARATED_CURL, QUANTITY_NAMES
from asterism.homogenize.universal.kriging import Kriging
from asterism.homogenize.universal.law_errors import DIMENSIONLESS_ERROR_FLOORS
from asterism.homogenize.universal.likelihood import likely_covariance
from asterism.homogenize.universal.universal_law import from_smooth, kernel_factors, kriging_places, to_smooth
from asterism.homogenize.universal.universal_law_file import load_universal_law
from benchmarks.report import markdown, write_report

FOLDS = 5
DEGREE = 3
SHARES = (50, 95)
COMPARED = ("lam_n", "kappa", "bending")
# from places and factors of known cells and their values to the values at other places
Way = Callable[[Floats, Floats, Floats, Floats, Floats], Floats]


def kriging(places: Floats, factors: Floats, values: Floats, asked: Floats, asked_factors: Floats) -> Floats:
    covariance = likely_covariance(places, factors, values)
    return Kriging.through(places, factors, values[:, None], covariance).values(asked, asked_factors)[:, 0]


def even_kriging(places: Floats, factors: Floats, values: Floats, asked: Floats, asked_factors: Floats) -> Floats:
    covariance = likely_covariance(places, factors, values, even_noise=True)
    return Kriging.through(places, factors, values[:, None], covariance).values(asked, asked_factors)[:, 0]


def radial(places: Floats, factors: Floats, values: Floats, asked: Floats, asked_factors: Floats) -> Floats:
    return np.asarray(RBFInterpolator(places, values / factors, kernel="cubic")(asked) * asked_factors)


def scaled_radial(places: Floats, factors: Floats, values: Floats, asked: Floats, asked_factors: Floats) -> Floats:
    lengths = likely_covariance(places, factors, values, even_noise=True).lengths
    return radial(places / lengths, factors, values, asked / lengths, asked_factors)


def polynomial_chaos(places: Floats, factors: Floats, values: Floats, asked: Floats, asked_factors: Floats) -> Floats:
    known, new = _monomials(places), _monomials(asked)
    return np.asarray(new @ np.linalg.lstsq(known, values / factors, rcond=None)[0] * asked_factors)


def _monomials(places: Floats) -> Floats:
    """(n, M) products of at most `DEGREE` centred coordinates; least squares do not depend on their basis."""
    x = np.column_stack([np.ones(len(places)), 2.0 * places - 1.0])
    return np.column_stack(
        [np.prod(x[:, list(chosen)], axis=1) for chosen in combinations_with_replacement(range(x.shape[1]), DEGREE)]
    )


WAYS: dict[str, Way] = {
    "kriging (Matern 5/2)": even_kriging,
    "the same, scatter by place": kriging,
    "RBFInterpolator, cubic": radial,
    "the same, scaled by the lengths": scaled_radial,
    "polynomial chaos of degree 3": polynomial_chaos,
}


def main() -> None:
    law = load_universal_law()
    groups, rows = law.groups[law.spread], law.rows[law.spread]
    smooth, places = to_smooth(rows, groups), kriging_places(groups)
    fold = np.random.default_rng(0).permutation(len(rows)) % FOLDS
    separated = np.abs(rows[:, QUANTITY_NAMES.index("kappa")]) <= MAX_SEPARATED_CURL
    lines, results = [], []
    for name, way in WAYS.items():
        begin, given = time.perf_counter(), smooth.copy()
        for quantity in COMPARED:
            column, factors = QUANTITY_NAMES.index(quantity), kernel_factors(quantity, groups)
            for number in range(FOLDS):
                test = fold == number
                given[test, column] = way(
                    places[~test], factors[~test], smooth[~test, column], places[test], factors[test]
                )
        values = from_smooth(given, groups)
        cells = [name]
        result: dict[str, Any] = {"way": name, "cells": int(separated.sum())}
        for quantity in COMPARED:
            n = QUANTITY_NAMES.index(quantity)
            size = np.maximum(np.abs(rows[:, n]), DIMENSIONLESS_ERROR_FLOORS.get(quantity, 0.0))
            percent = (100.0 * np.abs(values[:, n] - rows[:, n]) / size)[separated]
            shares = np.percentile(percent, SHARES).tolist()
            result[quantity] = shares
            cells.append(" / ".join(f"{share:.2f}" for share in shares))
        result["seconds"] = time.perf_counter() - begin
        results.append(result)
        lines.append([*cells, f"{result['seconds']:.0f}"])
    text = markdown(["", *(f"{name}: median / 95 %" for name in COMPARED), "s"], lines)
    write_report("universal_interpolation", results, text)
    print(text)


if __name__ == "__main__":
    main()
