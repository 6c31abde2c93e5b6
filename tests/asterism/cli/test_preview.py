"""`asterism preview --edge`: the mesh that the preview goes with."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.cli.common.errors import Mistake
from asterism.cli.preview import _check_command, _edge_mm


def test_an_edge_is_a_length_or_the_limit() -> None:
    assert _edge_mm("0.7") == 0.7 and _edge_mm("limit") == 0.0


@pytest.mark.parametrize("text", ["0", "0.1", "fine", "nan", "inf", "-1", "1e9", ""])
def test_other_edges_are_refused_in_one_line(text: str) -> None:
    with pytest.raises(Mistake, match=r"--edge: .* must be a length from 0\.2 to 100 mm, or limit"):
        _edge_mm(text)


@pytest.mark.parametrize(("edge", "words"), [(None, ""), ("0.7", " --edge 0.7"), ("limit", "")])
def test_the_check_has_the_mesh_of_the_preview(edge: str | None, words: str) -> None:
    """A limit has no exact mesh: that of the design is checked."""
    made = _check_command(Path("my dome.toml"), Path("own.npz"), Path("knit.toml"), edge)
    assert made == f"asterism verify 'my dome.toml' --law own.npz --material knit.toml{words}"
