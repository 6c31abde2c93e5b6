"""Results read back as the shape that wrote them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import asterism
from asterism.pattern.design.errors import DesignError
from asterism.shape.read_shape import read_shape
from asterism.shape.shape import Shape


@pytest.fixture(scope="module")
def shape() -> Shape:
    return asterism.simulate(
        asterism.Design.from_dict(
            {
                # arms reach the neighbours' centres: rods share vertices
                "stars": {"length_fraction": 1.0, "thickness_mm": 0.5, "width_mm": 0.8},
                "border": {"rings": 1},
                "mesh": {"edge_mm": 5.0},
            }
        )
    )


@pytest.fixture(scope="module")
def written(shape: Shape, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("results") / "out"
    asterism.write_results(shape, path)
    return path


@pytest.fixture
def results(written: Path, tmp_path: Path) -> Path:
    """A copy to spoil."""
    return Path(shutil.copytree(written, tmp_path / "out"))


def test_a_result_is_read_as_it_was(shape: Shape, results: Path) -> None:
    for path in (results, results / "shape.vtu"):
        again = read_shape(path)
        for name in ("printed", "positions", "triangles", "star", "star_vertices", "rod_edges"):
            assert np.array_equal(getattr(again, name), getattr(shape, name)), name
        for name in ("point_fields", "cell_fields", "rod_fields"):
            old, new = getattr(shape, name), getattr(again, name)
            assert set(old) == set(new)
            assert all(np.array_equal(old[key], new[key], equal_nan=True) for key in old)
        assert again.summary["design"] == shape.summary["design"]
        assert again.at(np.array([[3.0, 4.0]])) == pytest.approx(shape.at(np.array([[3.0, 4.0]])))


def test_the_sheet_alone_is_enough(results: Path) -> None:
    (results / "rods.vtu").unlink()
    (results / "summary.json").unlink()
    again = read_shape(results)
    assert again.rods == () and again.summary == {} and len(again.triangles)


def test_a_held_sheet_stays_one(results: Path) -> None:
    assert not read_shape(results).held
    summary = json.loads((results / "summary.json").read_text())
    summary["design"]["pins"] = [{"where": "corners"}]
    (results / "summary.json").write_text(json.dumps(summary))
    assert read_shape(results).held


def test_what_is_not_a_shape_is_named(results: Path, tmp_path: Path) -> None:
    with pytest.raises(DesignError, match=r"nowhere.shape\.vtu: is not there|nowhere: is not there"):
        read_shape(tmp_path / "nowhere")
    (results / "rods.vtu").write_bytes((results / "shape.vtu").read_bytes())
    with pytest.raises(DesignError, match=r"rods\.vtu: must hold lines"):
        read_shape(results)
    (results / "rods.vtu").unlink()
    whole = (results / "shape.vtu").read_bytes()
    for broken in (b"", b"not xml", whole[: len(whole) // 2], whole.replace(b"printed_mm", b"something_")):
        (results / "shape.vtu").write_bytes(broken)
        with pytest.raises(DesignError, match=r"shape\.vtu: (cannot be read|must hold)") as caught:
            read_shape(results)
        assert "\n" not in str(caught.value)
    (results / "shape.vtu").write_bytes(whole)
    (results / "summary.json").write_text("{")
    with pytest.raises(DesignError, match=r"summary\.json: cannot be read as JSON"):
        read_shape(results)
