"""The list of measured materials in words."""

from __future__ import annotations

from pathlib import Path

from asterism.homogenize.law.material import Material, load_material
from asterism.pattern.design.residual_curvature import ResidualCurvature


def material_in_words(path: Path) -> str:
    """One line on a material file: the plastic, the fabric, where the values come from and when they were measured.

    Raises
    ------
    DesignError
        The file is not a material.

    Examples
    --------
    >>> from asterism.pattern.design.material_files import material_files
    >>> material_in_words(material_files()["paper"]).split("; ")[0]
    'E1/E2 3200 (paper), kappa_bar 0 /mm'
    """
    material = load_material(path, plan_is_used=False)
    return "; ".join([_plastic(material), _fabric(material), _measured(material)])


def _plastic(material: Material) -> str:
    plastic = material.plastic
    kept = plastic.kappa_bar_per_mm
    bar = "by thickness" if isinstance(kept, ResidualCurvature) else f"{kept:.4g} /mm"
    return f"E1/E2 {plastic.modulus_ratio:.4g} ({plastic.rest_curvature}), kappa_bar {bar}"


def _fabric(material: Material) -> str:
    fabric = material.fabric
    at = f", at stretch {fabric.stretch_xy[0]:g}" if "stretch" in fabric.model_fields_set else ""
    modulus = f", E {fabric.modulus_mpa:g} MPa" if "modulus_mpa" in fabric.model_fields_set else ""
    return f"fabric {fabric.thickness_mm:g} mm{at}{modulus}"


def _measured(material: Material) -> str:
    if material.measured is None:
        return "source not given"
    date = "" if material.measured.date is None else f", {material.measured.date}"
    return f"{material.measured.source}{date}"
