"""Mutated inputs over all commands: designs, materials, strips, laws, scans, targets, drawings, results, profiles
and options.

python -m benchmarks.fuzz [COUNT] [--first NUMBER] [--verbose] [--keep FILE]

A case is its number: the same number gives the same files and the same command line. A failure is a traceback, an exit
status other than 0, 1 and 2, one without a reason, more than 60 s of processor time, a file that is left behind, a
result that is no number, or a sheet that is larger than its print by more than a quarter.

`--keep` writes each outcome into a file, one line each, and skips the cases that the file has: a long run can be
stopped and continued. The table is then that of all cases in the file.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

# a copy of a process with several threads would wait for threads that it does not have
for _name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
os.environ.setdefault("MPLBACKEND", "Agg")

from benchmarks.fuzz.cases import SEED  # noqa: E402
from benchmarks.fuzz.kept_outcomes import keep_outcome, read_outcomes  # noqa: E402
from benchmarks.fuzz.run import Outcome, run_cases, summary  # noqa: E402
from benchmarks.report import markdown, write_report  # noqa: E402

HEADER = ["input", "cases", "exit status 0", "1", "2", "longest, s", "failures"]
ON_DEMAND = 5000


def tell(outcome: Outcome, verbose: bool = False) -> None:
    """Print a failure at once; of all cases how they ended, if `verbose`."""
    case = f"{outcome.case.number} {outcome.case.kind}: asterism {' '.join(outcome.case.words)}"
    if verbose:
        print(f"{case}: {outcome.status}, {outcome.last_line}", flush=True)
    for line in outcome.failures:
        print(f"{case}: {line}", flush=True)


def main() -> None:
    """Run the cases, print the failures and the table, and write the table of a complete run."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz")
    parser.add_argument("count", nargs="?", type=int, default=ON_DEMAND)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--verbose", action="store_true", help="print how each case ended")
    parser.add_argument("--keep", type=Path, help="file of outcomes, which a later run continues")
    words = parser.parse_args()
    kept = read_outcomes(words.keep)
    done = {outcome.case.number for outcome in kept}
    numbers = [number for number in range(words.first, words.first + words.count) if number not in done]

    def take(outcome: Outcome) -> None:
        tell(outcome, words.verbose)
        if words.keep:
            keep_outcome(outcome, words.keep)

    outcomes = sorted([*kept, *run_cases(numbers, take)], key=lambda outcome: outcome.case.number)
    failed = [outcome for outcome in outcomes if outcome.failures]
    table = markdown(HEADER, summary(outcomes))
    ends = f"{outcomes[0].case.number} to {outcomes[-1].case.number}"
    title = f"{len(outcomes)} cases, seed {SEED}, numbers {ends}: {len(failed)} failures."
    print(f"\n{title}\n\n{table}")
    if words.keep or words.count >= ON_DEMAND:
        rows = [{"number": o.case.number, "words": list(o.case.words), "failures": list(o.failures)} for o in failed]
        write_report("fuzz", rows, f"{title}\n\n{table}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
