"""Mutated inputs over all commands: designs, materials, strips, laws, scans, targets, drawings, results, profiles
and options.

python -m benchmarks.fuzz [COUNT] [--first NUMBER] [--kind KIND]

A case is its number: the same number gives the same files and the same command line. A failure is a traceback, an exit
status other than 0, 1 and 2, one without a reason, more than 60 s of processor time, a file that is left behind, a
result that is no number, lines of a nested drawing that another reader does not find, or a sheet that is larger than
its print by more than a quarter.
"""

from __future__ import annotations

import argparse
import os
import sys

# a copy of a process with several threads would wait for threads that it does not have
for _name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
os.environ.setdefault("MPLBACKEND", "Agg")

from benchmarks.fuzz.cases import MAKERS, SEED  # noqa: E402
from benchmarks.fuzz.run import Outcome, run_cases, summary  # noqa: E402
from benchmarks.report import markdown  # noqa: E402

HEADER = ["input", "cases", "exit status 0", "1", "2", "longest, s", "failures"]


def main() -> None:
    """Run the cases, print the failures and the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz")
    parser.add_argument("count", nargs="?", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--kind", choices=sorted(MAKERS), help="of all cases; by default all kinds")
    words = parser.parse_args()

    def tell(outcome: Outcome) -> None:
        case = f"{outcome.case.number} {outcome.case.kind}: asterism {' '.join(outcome.case.words)}"
        for line in outcome.failures:
            print(f"{case}: {line}", flush=True)

    outcomes = run_cases(range(words.first, words.first + words.count), tell, words.kind)
    failed = sum(bool(outcome.failures) for outcome in outcomes)
    title = f"{len(outcomes)} cases, seed {SEED}, from number {words.first}: {failed} failures."
    print(f"\n{title}\n\n{markdown(HEADER, summary(outcomes))}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
