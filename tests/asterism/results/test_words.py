"""Results that are certified, and still not reliable."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.results.words import doubts
from tests.asterism.commands import Cli

# an arm thicker than those of all cells of the included law
OUTSIDE = "[stars]\nlength_mm = 10.0\nthickness_mm = 2.0\n[border]\nrings = 0\n[mesh]\nedge_mm = 4.0\n"


def test_shapes_of_a_verification_are_doubted_once() -> None:
    shape = {"stars": 1, "stars_outside_law": ["star 0 is too long"], "self_intersections": 2}
    both = {"model": "verification", "preview": shape, "exact": {"stars_total": 1, "self_intersections": 2}}
    assert doubts(both) == ["the star is outside the law", "the sheet passes through itself (2 pairs of triangles)"]
    assert doubts({"stars": 2, "stars_outside_law": ["star 0"], "self_intersections": 0}) == []


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
@pytest.mark.parametrize(("options", "status"), [([], 0), (["--strict"], 1)])
def test_strict_ends_with_1_where_the_first_line_has_a_doubt(
    options: list[str], status: int, tmp_path: Path, cli: Cli
) -> None:
    (tmp_path / "d.toml").write_text(OUTSIDE)
    done = cli(["preview", str(tmp_path / "d.toml"), "--law", str(PAPER_LAW), *options])
    assert done.status == status, done.err
    assert done.out.splitlines()[0].split() == ["not", "reliable", "the", "star", "is", "outside", "the", "law"]
    assert (tmp_path / "d" / "summary.json").is_file()
