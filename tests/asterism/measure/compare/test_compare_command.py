"""`asterism compare` as its user meets it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from asterism.measure.outline import silhouette
from asterism.pattern.geometry.diameter import diameter
from asterism.shape.vtu import write_shape_vtu
from tests.asterism.commands import Cli
from tests.asterism.measure.compare.scans import bent_sheet, motion

SHAPE = bent_sheet()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_shape_vtu(SHAPE, tmp_path / "shape.vtu")
    return tmp_path


def scan(path: Path, scale: float = 1.0) -> None:
    rotation, shift = motion(3)
    x, y = SHAPE.printed.T
    bump = 2 * np.exp(-((x - 20) ** 2 + y**2) / 150)
    raised = SHAPE.positions + np.column_stack([0 * bump, 0 * bump, bump])
    trimesh.Trimesh((raised @ rotation.T + shift) * scale, SHAPE.triangles, process=False).export(path)


@pytest.mark.slow
def test_a_scan_in_inches(folder: Path, cli: Cli) -> None:
    scan(folder / "scan.obj", 1 / 25.4)
    words = ["compare", str(folder / "shape.vtu"), str(folder / "scan.obj")]
    refusal = cli(words).refusal
    assert "it seems to be in inches" in refusal and "--units in" in refusal
    assert not (folder / "scan-compared").exists()
    assert "--view is for outlines" in cli([*words, "--units", "in", "--view", "front"]).refusal
    done = cli([*words, "--units", "in"]).done
    assert "of the shape's diameter" in done.out and "perhaps another size" not in done.out
    numbers = json.loads((folder / "scan-compared" / "summary.json").read_text())
    assert numbers["units"] == "in" and 0.2 < numbers["rms_mm"] < 0.8 and numbers["shape_covered_percent"] > 98
    with Image.open(folder / "scan-compared" / "compare.png") as picture:
        assert picture.size == (1600, 860)
        # the shape is there, in colours: neither white nor grey
        colours = np.asarray(picture.convert("RGB"))[200:600, 100:700].reshape(-1, 3).astype(int)
        assert (np.ptp(colours, axis=1) > 8).mean() > 0.02


@pytest.mark.slow
def test_a_scan_that_fits_nowhere_ends_with_1(folder: Path, cli: Cli) -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform(-35, 35, (200, 3))
    (folder / "cloud.obj").write_text("\n".join(f"v {x:.3f} {y:.3f} {z:.3f}" for x, y, z in points))
    done = cli(["compare", str(folder / "shape.vtu"), str(folder / "cloud.obj")])
    assert done.status == 1 and "cloud.obj fits nowhere" in done.err
    assert (folder / "cloud-compared" / "summary.json").is_file()


@pytest.mark.slow
def test_a_scan_of_another_size(folder: Path, cli: Cli) -> None:
    trimesh.Trimesh(SHAPE.positions * 1.08, SHAPE.triangles, process=False).export(folder / "scan.ply")
    done = cli(["compare", str(folder / "shape.vtu"), str(folder / "scan.ply")]).done
    assert "perhaps another size" in done.out and "1.08" in done.out


def draw(path: Path, size: str, more: str = "") -> None:
    """A rectangle as large as the shape where the page is 120 mm wide."""
    shapes = f'<rect x="10" y="10" width="100" height="80"/>{more}'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size} viewBox="0 0 120 100">{shapes}</svg>')


@pytest.mark.slow
def test_drawings_with_other_lines_and_of_another_size(folder: Path, cli: Cli) -> None:
    """A picture's frame may be the largest."""
    draw(folder / "o.svg", 'width="120mm" height="100mm"', '<rect width="120" height="100"/>')
    words = ["compare", str(folder / "shape.vtu"), str(folder / "o.svg")]
    assert "2, of which the largest is compared" in cli(words).done.out
    numbers = json.loads((folder / "o-compared" / "summary.json").read_text())
    assert numbers["lines"] == 2 and numbers["units"] == "its own"
    draw(folder / "o.svg", 'width="12mm" height="10mm"')
    assert "in centimetres; correct its width and height" in cli(words).line


@pytest.mark.slow
@pytest.mark.parametrize(("scale", "poor"), [([1.02, 1.02], False), ([1.3, 0.7], True)])
def test_an_outline_from_above(scale: list[float], poor: bool, folder: Path, cli: Cli) -> None:
    corners = silhouette(SHAPE, "above") * scale + [10, 20]
    (folder / "outline.csv").write_text("x_mm,y_mm\n" + "".join(f"{x:.2f},{y:.2f}\n" for x, y in corners))
    words = ["compare", str(folder / "shape.vtu"), str(folder / "outline.csv"), "-o", str(folder / "out")]
    assert ("a poor fit" in cli(words).done.out) == poor
    numbers = json.loads((folder / "out" / "summary.json").read_text())
    assert numbers["area_of_outline_mm2"] == pytest.approx(8000 * np.prod(scale), rel=5e-3)
    assert numbers["diameter_mm"] == pytest.approx(diameter(SHAPE.positions))
    assert numbers["rms_percent"] == pytest.approx(100 * numbers["rms_mm"] / numbers["diameter_mm"])
    assert (numbers["rms_percent"] > 1.5) == poor and (poor or 0.4 < numbers["mean_outwards_mm"] < 1.1)
    assert (folder / "out" / "compare.png").stat().st_size > 10_000


@pytest.mark.slow
def test_a_mirrored_scan_is_not_taken_for_the_shape(folder: Path, cli: Cli) -> None:
    """Most of a shallow sheet's mirror image lies on it; what does not is left out, and told."""
    mirrored = SHAPE.positions * [1.0, 1.0, -1.0]
    trimesh.Trimesh(mirrored, SHAPE.triangles, process=False).export(folder / "scan.ply")
    done = cli(["compare", str(folder / "shape.vtu"), str(folder / "scan.ply")]).done
    assert "perhaps another shape" in done.out or "a poor fit" in done.out


@pytest.mark.parametrize(
    ("shape", "file", "content", "problem"),
    [
        ("shape.vtu", "none.obj", None, "none.obj: is not there"),
        ("none.vtu", "a.obj", b"v 1 2 3\n", "none.vtu"),
        ("shape.vtu", "a.obj", b"v 1e300 0 0\nv 0 1e300 0\nv 0 0 0\nf 1 2 3\n", "not finite numbers, or too far away"),
        ("shape.vtu", "a.txt", b"", "a.txt: must end in .obj"),
        ("a.vtu", "a.vtu", b"hello", "a.vtu: cannot be read as VTU"),
    ],
)
def test_mistakes(shape: str, file: str, content: bytes | None, problem: str, folder: Path, cli: Cli) -> None:
    if content is not None:
        (folder / file).write_bytes(content)
    before = sorted(folder.iterdir())
    assert problem in cli(["compare", str(folder / shape), str(folder / file)]).refusal
    assert sorted(folder.iterdir()) == before


def test_a_comparison_does_not_replace_its_shape(folder: Path, cli: Cli) -> None:
    (folder / "summary.json").write_text("{}")
    scan(folder / "scan.obj")
    for named in (folder, folder / "shape.vtu"):
        assert "holds the shape" in cli(["compare", str(named), str(folder / "scan.obj"), "-o", str(folder)]).refusal
    assert sorted(file.name for file in folder.iterdir()) == ["scan.obj", "shape.vtu", "summary.json"]
