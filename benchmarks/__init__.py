"""Measurements of accuracy and time that a maintainer repeats; each is one command, `python -m benchmarks.NAME`."""

from importlib.util import find_spec

# found without importing them: some commands set the number of threads first
if missing := [name for name in ("asterism", "numpy", "skfem") if find_spec(name) is None]:
    raise SystemExit(f"benchmarks need {', '.join(missing)}: pip install .")
