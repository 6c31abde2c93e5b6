"""The material file that strips give, for every command that takes one."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

from asterism.measure.strips.strip_fit import StripFit
from asterism.results.files import OutputError
from homogenize.law.material import Material

# a file that begins with this line is ours, and may be written over
FIRST_LINE = "# Written by asterism strips fit, which writes over this file as long as this line is here."
COMPANION_SUFFIXES = (".png", ".json")  # files of the same name that are written with it


def material_text(fit: StripFit, name: str, remarks: list[str]) -> str:
    """TOML of the material: thickness and stretch of the fabric, E1/E2, its convention, and kappa_bar."""
    lines = [FIRST_LINE, *(f"# {remark}" for remark in remarks)]
    lines += [f"name = {json.dumps(name, ensure_ascii=False)}", "", "[fabric]"]
    # without one value the commands keep the design's
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
    """Raise OutputError if there is a file that was not written by this command, or was claimed by its user."""
    foreign = None
    try:
        with path.open(encoding="utf-8") as stream:
            if stream.readline().strip() != FIRST_LINE:
                foreign = path
    except FileNotFoundError:
        # a picture or numbers of the same name without a material are somebody else's
        foreign = next((file for file in map(path.with_suffix, COMPANION_SUFFIXES) if file.exists()), None)
    except (OSError, UnicodeDecodeError):
        foreign = path
    if foreign:
        raise OutputError(f"{foreign} exists and was not written by asterism strips fit; choose another name with -o")


def _kappa_bar(fit: StripFit) -> str:
    if fit.kappa_bar_kind != "per-thickness":
        return f"{fit.kappa_bar[None].value:.4g}" if fit.kappa_bar else "0.0"
    values = ", ".join(f"{interval.value:.4g}" for interval in fit.kappa_bar.values())
    thicknesses = ", ".join(repr(float(h)) for h in fit.kappa_bar if h is not None)  # near ones stay apart
    return f"{{ thickness_mm = [{thicknesses}], per_mm = [{values}] }}"
