"""Further cells of the universal law, where the law misses its left-out cells most."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.law_table import MAX_SEPARATED_CURL, QUANTITY_NAMES
from asterism.homogenize.universal.law_errors import left_out_errors
from asterism.homogenize.universal.spread_cells import spread_groups
from asterism.homogenize.universal.universal_law import UniversalLaw, kriging_places

# of the sequence that candidates come from; the law's own cells have another one
CANDIDATE_SEED = 1
# candidates for each new cell
CANDIDATES_PER_CELL = 16
# cells whose left-out errors count at a candidate
NEIGHBOURS = 6
# errors count up to this, %: one cell on another branch must not draw all others
MAX_COUNTED_ERROR_PERCENT = 50.0
# quantities whose errors count, and their weights: contraction has to be known ten times better than the others
COUNTED_QUANTITIES = {"lam_n": 10.0, "kappa": 1.0, "bending": 1.0}


def refined_groups(law: UniversalLaw, count: int) -> Floats:
    """(count, G) groups of new cells, the most useful first. Equal laws give equal cells.

    The use of a candidate is the error that its neighbours in the law have when they are left out, times its distance
    to the nearest solved cell, also among those chosen before. Candidates that would wrap are left out.
    """
    pool = spread_groups(CANDIDATES_PER_CELL * count, CANDIDATE_SEED)
    curl = np.abs(law(pool)[:, QUANTITY_NAMES.index("kappa")])
    pool = pool[curl <= MAX_SEPARATED_CURL]
    lengths = law.parts["kappa"].covariance.lengths
    places = kriging_places(pool) / lengths
    errors = left_out_errors(law)
    columns = [QUANTITY_NAMES.index(name) for name in COUNTED_QUANTITIES]
    worst = (errors.percent[:, columns] * np.array(list(COUNTED_QUANTITIES.values()))).max(axis=1)
    counted = np.minimum(worst, MAX_COUNTED_ERROR_PERCENT)
    near = law.nearest_cells(pool, NEIGHBOURS)
    error = np.where(errors.separated[near], counted[near], 0.0).mean(axis=1)
    distance = cKDTree(kriging_places(law.cells.groups) / lengths).query(places)[0]
    chosen = []
    for _ in range(min(count, len(pool))):
        best = int(np.argmax(error * distance))
        chosen.append(best)
        distance = np.minimum(distance, np.linalg.norm(places - places[best], axis=1))
    return pool[chosen]
