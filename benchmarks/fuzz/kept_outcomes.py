"""Outcomes of cases in a file, one JSON object a line: a long run can be stopped and continued."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from benchmarks.fuzz.cases import Case
from benchmarks.fuzz.run import Outcome


def keep_outcome(outcome: Outcome, file: Path) -> None:
    """Add an outcome to a file."""
    with file.open("a", encoding="utf-8") as stream:
        stream.write(json.dumps(asdict(outcome)) + "\n")


def read_outcomes(file: Path | None) -> list[Outcome]:
    """The outcomes of earlier runs; none without a file."""
    if file is None or not file.exists():
        return []
    return [_outcome(json.loads(line)) for line in file.read_text(encoding="utf-8").splitlines()]


def _outcome(row: dict[str, object]) -> Outcome:
    case, failures = row["case"], row["failures"]
    assert isinstance(case, dict) and isinstance(failures, list)
    whole = {**row, "case": Case(**{**case, "words": tuple(case["words"])}), "failures": tuple(failures)}
    return Outcome(**whole)  # type: ignore[arg-type]
