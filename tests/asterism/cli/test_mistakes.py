"""A mistake in the words of a command, or in a file that they name, is one line with status 2, and nothing is left."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from tests.asterism.commands import Cli

DESIGN = "[stars]\nlength_mm = 8.0\n[border]\nrings = 1\n"
FILES = {
    "d.toml": DESIGN,
    "bad.toml": DESIGN.replace("8.0", "-1.0"),
    "fall.toml": DESIGN + "[gravity]\non = true\n[fabric]\nmodulus_mpa = 7.0\n",
    "hinges.toml": DESIGN + '[fabric]\nbending = "paper"\n',
    "large.toml": DESIGN.replace("rings = 1", "rings = 8") + "[mesh]\nedge_mm = 0.5\n",
    "planned.toml": DESIGN + "[plan]\nheld_out = 0\n",
    "plan.toml": "[plan]\nheld_out = 0\n",
    "coarse.toml": "[plan]\nedge_mm = 40\n",
    "unbent.toml": '[fabric]\nbending = "none"\n',
    "not.npz": "a law?",
}
WRITING = ("simulate", "preview", "verify", "export", "report", "calibrate")
NO_OUTPUT = "'--output': must not be empty"
MISTAKES = [
    ("simulat d.toml", "simulat"),
    ("simulate", "design"),
    ("simulate none.toml", "none.toml"),
    (f"simulate {300 * 'x'}.toml", "too long"),
    ("simulate d.toml --edge nan", "--edge"),
    ("simulate d.toml --edge two", "--edge"),
    ("simulate d.toml --starts 0", "--starts"),
    ("simulate d.toml -o d.toml", "d.toml"),
    ("simulate d.toml --colour red", "--colour"),
    ("simulate large.toml", "use --yes to compute it, or a larger mesh.edge_mm"),
    ("export large.toml --simulate", "takes about 2829"),
    *((f"{name} fall.toml", "fall.toml: gravity.on = True: needs [[pins]]") for name in ("preview", "simulate")),
    ("report fall.toml", "fall.toml: gravity.on = True: needs [[pins]]"),
    ("verify d.toml --law not.npz", "not.npz"),
    ("verify d.toml --backend none", "backend: 'none'"),
    ("verify d.toml --tolerance 1 --edge 3", "--tolerance: goes without --edge"),
    ("verify d.toml --tolerance 0", "--tolerance = 0.0"),
    ("verify hinges.toml --tolerance 1", "--tolerance: not for fabric.bending = 'paper'"),
    ("new spaceship -o x.toml", "gallery"),
    ("new tube -o x.png", ".toml"),
    ("export d.toml --printer mine.toml", "mine.toml: cannot be read"),
    ("export d.toml --layer 1.9", "--layer = 1.9: must be at most the nozzle's 0.4 mm"),
    ("export d.toml --first-layer 0.5", "--first-layer = 0.5: must be at most the nozzle's 0.4 mm"),
    ("export d.toml --plate -1", "--plate = -1.0: must be at least 0"),
    ("export d.toml --fabric nan", "--fabric = nan: must be from 0.01 to 50"),
    ("export d.toml --shape nowhere", "nowhere: is not there"),
    ("export d.toml --shape x --simulate", "--shape: must be the only one"),
    ("report d.toml -o r.png", "must end with .pdf"),
    ("report d.toml --printer none", "--printer"),
    ("report d.toml --material none.toml", "none.toml"),
    ("report d.toml --results nowhere", "nowhere"),
    ("compare-designs d.toml", "asterism: must be 2 to 12 design files, not 1"),
    ("compare-designs d.toml d.toml -o x.pdf", "asterism: --output: 'x.pdf' must end with .html"),
    ("calibrate none.toml", "none.toml"),
    ("calibrate coarse.toml", "coarse.toml: plan.edge_mm = 40"),
    ("calibrate plan.toml -o law.txt", "must end with .npz"),
    ("calibrate plan.toml --jobs 0", "--jobs"),
    ("calibrate plan.toml --jobs 2 --dask tcp://127.0.0.1:1", "--jobs"),
    ("calibrate planned.toml", "planned.toml: plan"),
    ("calibrate unbent.toml", "fabric.bending"),
    ("calibrate unbent.toml --material unbent.toml", "--material = 'unbent.toml': goes with a design"),
    ("calibrate d.toml --material unbent.toml", "fabric.bending"),
    pytest.param("calibrate plan.toml --dask nonsense://here", "no scheduler answers", marks=pytest.mark.slow),
    ("law show plan.toml", "not a law"),
    ("law show none.npz", "none.npz: cannot be read"),
    ("strips", "strips: needs a command: new, fit, weigh or overhang"),
    ("strips new --count 60", "--count = '240 strips of 60 mm'"),
    ("strips new --thickness 0.3 --thickness 0.3", "twice"),
    ("strips new --printer none", "--printer"),
    ("strips new --stretch 1", "--stretch"),
    ("strips overhang --form x --mass 250", "--form: writes an empty table"),
    ("strips overhang --mass 250", "MM: give overhangs in mm or their table"),
    ("strips overhang 52", "--mass: is missing"),
    ("strips overhang 5l --mass 250", "not '5l'"),
    ("strips overhang 5 --mass 250", "reading 1 = 5.0: must be from 10 to 500 mm"),
    ("strips overhang 50 --mass 0", "--mass = 0.0: must be from 10 to 5000 g for a square metre"),
    ("studio nothing.toml --no-browser", "nothing.toml"),
    ("studio bad.toml --no-browser", "stars.length_mm"),
    ("studio d.txt --no-browser", ".toml"),
    ("studio d.toml --listen 0.0.0.0 --no-browser", "0.0.0.0"),
    ("studio d.toml --listen 192.0.2.1 --no-browser", "192.0.2.1"),
    ("studio d.toml --port 70000 --no-browser", "--port"),
    ("hops --folder nothing", "nothing"),
    ("hops --port 70000", "--port"),
    ("hops --patience 0", "--patience"),
    # an empty output is not the working directory
    *((f"{name} d.toml -o ''", NO_OUTPUT) for name in WRITING),
    *((f"{words} -o ''", NO_OUTPUT) for words in ("new dome", "law show", "strips new")),
]


@pytest.mark.parametrize(("words", "expected"), MISTAKES)
def test_mistakes_are_one_line_and_leave_nothing(
    words: str, expected: str, here: Path, cli: Cli, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ASTERISM_CELLS", str(here / "cells"))
    for name, text in FILES.items():
        (here / name).write_text(text)
    assert expected in cli(shlex.split(words)).refusal
    assert {file.name for file in here.iterdir()} - {"cells"} == set(FILES) and not list(here.glob("cells/*"))
