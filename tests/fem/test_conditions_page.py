"""The page on conditions and loads: its program runs and finds a minimum."""

import re
from pathlib import Path

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "shell-supports.md").read_text(encoding="utf-8")


def test_the_program_runs() -> None:
    (program,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    names: dict = {}
    exec(program, names)
    assert names["found"].is_minimum
    # too long for its frame, and its edges are held: the middle stands out
    assert abs(names["middle"][0, 2]) > 1.0


def test_the_tests_it_names_are_there() -> None:
    folder = Path(__file__).parents[1] / "validation"
    named = set(re.findall(r"`(test_\w+\.py)`", PAGE))
    assert named == {path.name for path in folder.glob("test_shell_*.py")}
