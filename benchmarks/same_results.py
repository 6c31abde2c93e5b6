"""Do two checkouts of the project compute the same? Previews and exact shapes of the gallery and of drawn designs.

python -m benchmarks.same_results OTHER_CHECKOUT [--drawn 20] [--designs NAME ...]

Each checkout verifies every design in a process of its own, with the Python of this one. Compared are heights and
energies of the preview and of both exact shapes, the distance between them and what the preview states about its error;
where there is no law for a design, of its exact shape.
Exit status 1 if a number differs by more than 1e-9 of itself.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from asterism.pattern import gallery
from asterism.pattern.design.design import save_design
from benchmarks.frozen.draw import WORKING, frozen
from benchmarks.report import ROOT

TOLERANCE = 1e-9
# only the public API, which both checkouts have
PROGRAM = """
import json, sys
import asterism

design = asterism.load_design(sys.argv[1])
try:
    both = asterism.verify(design)
    shapes, comparisons = {"preview": both.preview, **both.exact}, both.comparisons
except ValueError:  # there is no law for the design, and so no preview
    shapes, comparisons = {"exact": asterism.simulate(design)}, {}
numbers = {}
for name, shape in shapes.items():
    for key in ("height_mm", "energy_n_mm", "expected_rms_percent", "expected_height_percent", "contraction"):
        numbers[f"{name}.{key}"] = shape.summary.get(key)
    numbers[f"{name}.extent_mm"] = list(shape.extent_mm)
    numbers[f"{name}.warnings"] = len(shape.summary["warnings"])
for name, comparison in comparisons.items():
    numbers[f"{name}.rms_percent"] = float(comparison.rms_percent)
json.dump(numbers, sys.stdout)
"""


def main() -> int:
    """Compare, print one line a design, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.same_results")
    parser.add_argument("other", type=Path)
    parser.add_argument("--drawn", type=int, default=20)
    parser.add_argument("--designs", nargs="*")
    options = parser.parse_args()
    designs = [gallery.load(name) for name in gallery.names()]
    designs += [design for _, design in frozen(WORKING)[: options.drawn]]
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for design in designs:
            if options.designs is None or design.name in options.designs:
                save_design(design, Path(folder) / f"{design.name}.toml")
                both = [_numbers(each, Path(folder) / f"{design.name}.toml") for each in (options.other, ROOT)]
                place, largest = difference(*both)
                worst = max(worst, largest)
                print(f"{design.name:<28} {largest:.1e}  {place}", flush=True)
    print(f"largest relative difference: {worst:.1e} (allowed {TOLERANCE:.0e})")
    return int(worst > TOLERANCE)


def _numbers(checkout: Path, design: Path) -> dict[str, Any]:
    environment = {**os.environ, "PYTHONPATH": str(checkout.resolve())}
    command = [sys.executable, "-c", PROGRAM, str(design)]
    ran = subprocess.run(command, cwd=checkout, env=environment, capture_output=True, text=True, check=False)
    if ran.returncode:
        raise SystemExit(f"{checkout}: {design.stem}: {ran.stderr.strip().splitlines()[-1]}")
    found: dict[str, Any] = json.loads(ran.stdout)
    return found


def difference(one: dict[str, Any], other: dict[str, Any]) -> tuple[str, float]:
    """Key of the largest relative difference, and that difference; infinite where only one has a number."""
    found = [("", 0.0)]
    for key in sorted(one.keys() | other.keys()):
        a, b = one.get(key), other.get(key)
        if a is None or b is None:
            found.append((key, 0.0 if a is b else float("inf")))
            continue
        pairs = zip(a, b, strict=True) if isinstance(a, list) else [(a, b)]
        found += [(key, abs(x - y) / max(abs(x), abs(y), 1e-9)) for x, y in pairs if x != y]
    return max(found, key=lambda item: item[1])


if __name__ == "__main__":
    sys.exit(main())
