"""The example of the shell's page."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

PAGE = Path(__file__).parents[2] / "docs" / "explanation" / "shell.md"


def test_the_example_runs() -> None:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    names: dict[str, Any] = {}
    exec(code, names)
    assert names["found"].is_minimum
    assert names["places"].shape == (2, 3)
    assert np.linalg.norm(names["places"][1] - names["places"][0]) < 0.8 * 50.0 * np.sqrt(2.0)
