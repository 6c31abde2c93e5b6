"""Measurements that a maintainer repeats; each is one command, `python -m benchmarks.NAME`.

`accuracy`, `exact`, `fit_targets`, `large`, `preview`, `spread` and `studio` write the tables in `results`, and
`fit_constants` the constants of previews; `pictures` draws those of the pages. `same_results OTHER_CHECKOUT` is for
changes that must move no result: it compares heights, energies and distances of two checkouts. `fuzz` runs commands on
changed designs.
"""

from importlib.util import find_spec

# found without importing them: some commands set the number of threads first
if missing := [name for name in ("asterism", "numpy", "skfem") if find_spec(name) is None]:
    raise SystemExit(f"benchmarks need {', '.join(missing)}: pip install .")
