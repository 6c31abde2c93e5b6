"""The material file that a fit of strips writes."""

from __future__ import annotations

import datetime
import json
import tomllib
from pathlib import Path

from asterism.homogenize.law.material import Material
from asterism.measure.strips.strip_fit import StripFit
from asterism.results.files import OutputError

# a file with this first line was written by the command, which may replace it
MATERIAL_FIRST_LINE = "# Written by asterism strips fit, which writes over this file as long as this line is here."
COMPANION_SUFFIXES = (".png", ".json")  # files of the same name that are written with it


def material_text(fit: StripFit, name: str, remarks: list[str], source: str) -> str:
    """TOML of the material: thickness and stretch of the fabric, E1/E2, its convention, and kappa_bar.

    `source` is a line on the measurement, to which the day is added.
    """
    lines = [MATERIAL_FIRST_LINE, *(f"# {remark}" for remark in remarks)]
    lines += [f"name = {json.dumps(name, ensure_ascii=False)}", ""]
    lines += ["[measured]", f"source = {json.dumps(source, ensure_ascii=False)}"]
    lines += [f'date = "{datetime.date.today().isoformat()}"', "", "[fabric]"]
    # with several values the key is left out, and commands use the design's value
    lines += [f"{key} = {values.pop():g}" for key, values in fit.fabrics.items() if len(values) == 1]
    lines += [
        "",
        "[plastic]",
        f"modulus_ratio = {fit.ratio[fit.formula].value:.5g}",
        f'rest_curvature = "{fit.formula}"',
        f"kappa_bar_per_mm = {_kappa_bar(fit)}",
    ]
    text = "\n".join(lines) + "\n"
    Material.from_dict(tomllib.loads(text))
    return text


def check_ours(path: Path) -> None:
    """Raise OutputError if `path` holds a file without the first line that this command writes."""
    foreign = None
    try:
        with path.open(encoding="utf-8") as stream:
            if stream.readline().strip() != MATERIAL_FIRST_LINE:
                foreign = path
    except FileNotFoundError:
        # a picture or numbers without a material come from something else
        foreign = next((file for file in map(path.with_suffix, COMPANION_SUFFIXES) if file.exists()), None)
    except (OSError, UnicodeDecodeError):
        foreign = path
    if foreign:
        raise OutputError(f"{foreign} exists and was not written by asterism strips fit; choose another name with -o")


def _kappa_bar(fit: StripFit) -> str:
    if fit.kappa_bar_kind != "per-thickness":
        return f"{fit.kappa_bar[None].value:.4g}" if fit.kappa_bar else "0.0"
    values = ", ".join(f"{interval.value:.4g}" for interval in fit.kappa_bar.values())
    thicknesses = ", ".join(
        repr(float(h)) for h in fit.kappa_bar if h is not None
    )  # repr keeps thicknesses apart that are nearly equal
    return f"{{ thickness_mm = [{thicknesses}], per_mm = [{values}] }}"
