"""Files that are no target: one line each, with the file's name, and nothing is written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.fitting.target import load_target
from tests.asterism.commands import Cli
from tests.asterism.fitting.broken_targets import BROKEN_FILES, BrokenTarget, dome, meshed, png_bytes

IN_ONE_FOLDER = settings(
    max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)


@pytest.mark.slow
@pytest.mark.parametrize("broken", BROKEN_FILES, ids=[f"{one.name}: {one.problem}" for one in BROKEN_FILES])
def test_the_command_ends_with_one_line(broken: BrokenTarget, tmp_path: Path, cli: Cli) -> None:
    path = tmp_path / broken.name
    broken.write(path)
    before = sorted(tmp_path.iterdir())
    outcome = cli(["fit", str(path), "--quiet", "--no-exact", *broken.options])
    assert broken.problem in outcome.line and broken.name in outcome.line
    assert outcome.status == broken.status
    assert sorted(tmp_path.iterdir()) == before


def refused_in_one_line(path: Path, **options: float | tuple[float, float]) -> bool:
    """Whether a file is refused; every other error fails the test."""
    try:
        target = load_target(path, **options)  # type: ignore[arg-type]
    except Error as error:
        assert "\n" not in str(error) and path.name in str(error)
        return True
    assert np.isfinite(target.disk.vertices).all()
    return False


SOUND = {"dome.stl": meshed(dome(points=9)), "dome.png": png_bytes()}


@pytest.mark.slow
@pytest.mark.parametrize("name", SOUND)
@given(data=st.data())
@IN_ONE_FOLDER
def test_damaged_files_are_refused_in_one_line(name: str, tmp_path: Path, data: st.DataObject) -> None:
    content = bytearray(SOUND[name])
    for _ in range(data.draw(st.integers(0, 3))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / name
    path.write_bytes(bytes(content[: data.draw(st.integers(0, len(content)))]))
    heights = {} if name.endswith(".stl") else {"heights_mm": (0.0, 12.0), "extent_mm": 90.0}
    refused_in_one_line(path, **heights)


@pytest.mark.slow
@given(arrays(float, array_shapes(max_dims=3, max_side=9), elements=st.floats(allow_nan=True, width=32)))
@IN_ONE_FOLDER
def test_random_arrays_are_targets_or_refused_in_one_line(tmp_path: Path, heights: Floats) -> None:
    path = tmp_path / "heights.npy"
    np.save(path, heights)
    refused_in_one_line(path, extent_mm=90.0)


@given(st.text(max_size=60))
@IN_ONE_FOLDER
def test_random_tables_are_targets_or_refused_in_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "heights.csv"
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    refused_in_one_line(path, extent_mm=90.0)
