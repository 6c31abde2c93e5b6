"""A picture of a fit: curvatures over the thickness, and the line whose slope is E2/E1."""

from __future__ import annotations

from pathlib import Path
from typing import IO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from asterism.draw.chart_axes import add_grid, style_axes
from asterism.draw.colours import PALE
from asterism.draw.fonts import write_title
from asterism.equilibrium.arrays import Floats
from asterism.measure.strips.reading import Reading
from asterism.measure.strips.strip_fit import StripFit
from asterism.pattern.design.materials import Fabric, Plastic, bilayer_curvature, rest_curvature
from asterism.pattern.design.residual_curvature import residual_curvature

WITH_FABRIC_COLOUR = "#2a6f97"
PEELED_COLOUR = "#c8553d"
OUTLIER_COLOUR = "#9d1f1f"
# modulus ratio at which the curvature is proportional to E2/E1 in both conventions
_STIFF_MODULUS_RATIO = 1e9


def draw_fit(fit: StripFit, title: str, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw a fit as PNG."""
    figure = Figure(figsize=(12, 5.4), dpi=150, facecolor="white")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2)
    figure.subplots_adjust(left=0.07, right=0.985, bottom=0.12, top=0.79, wspace=0.2)
    _over_thickness(left, fit)
    _line(right, fit)
    ratio = fit.ratio[fit.formula]
    high = f"{ratio.high:.0f}" if np.isfinite(ratio.high) else "no bound"
    text = f"E1/E2 = {ratio.value:.0f}, {ratio.low:.0f} to {high} ({100 * fit.confidence:g} %)"
    text += f', rest_curvature = "{fit.formula}"; shaded: the interval of E1/E2; crosses: left out'
    write_title(figure, 0.012, 0.93, title, 14)
    figure.text(0.012, 0.88, text, fontsize=10, color=PALE, parse_math=False)
    figure.savefig(path_or_file, format="png", dpi=150)


def _over_thickness(axes: Axes, fit: StripFit) -> None:
    readings = [*fit.used, *(out.reading for out in fit.left_out)]
    thicknesses = [r.thickness_mm for r in readings]
    h = np.linspace(min(thicknesses) - 0.01, max(thicknesses) + 0.01, 200)
    one = fit.used[0]
    fabric = Fabric(stretch=one.stretch, thickness_mm=one.fabric_thickness_mm)
    with_fabric = [rest_curvature(h, fabric, plastic) for plastic in _plastics(fit)]
    axes.fill_between(h, with_fabric[1], with_fabric[2], color=WITH_FABRIC_COLOUR, alpha=0.2, linewidth=0)
    axes.plot(h, with_fabric[0], color=WITH_FABRIC_COLOUR, linewidth=1.2)
    if fit.kappa_bar:
        axes.plot(h, residual_curvature(h, fit.plastic().kappa_bar_per_mm), color=PEELED_COLOUR, linewidth=1.2)
    for peeled, colour, label in ((False, WITH_FABRIC_COLOUR, "with fabric"), (True, PEELED_COLOUR, "peeled")):
        some = [r for r in fit.used if r.peeled == peeled]
        bent = [r for r in some if r.curvature_per_mm is not None]
        flat = [r for r in some if r.curvature_per_mm is None]
        if bent:
            axes.plot(_h(bent), _kappa(bent), "o", color=colour, markersize=4, alpha=0.6, label=label)
        if flat:
            limits = [8 * fit.flat_height_mm / r.length_mm**2 for r in flat]
            axes.plot(
                _h(flat), limits, "v", color=colour, markersize=6, fillstyle="none", label=f"{label}, flat: below"
            )
    for out in fit.left_out:
        place = (out.reading.thickness_mm, out.reading.curvature_per_mm or 0.0)
        axes.plot(*place, "x", color=OUTLIER_COLOUR, markersize=8)
        axes.annotate(f"  {out.reading.strip}", place, fontsize=8, color=OUTLIER_COLOUR, va="center")
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    style_axes(axes, "curvature of the strips, 1/mm", "thickness of the plastic, mm")
    add_grid(axes)
    axes.legend(fontsize=8, frameon=False)


def _line(axes: Axes, fit: StripFit) -> None:
    """Draw the curvature without kappa_bar over its factor in the formula: a line with the slope E2/E1."""
    bent = [r for r in fit.used if not r.peeled and r.curvature_per_mm is not None]
    axes.plot(
        _factor(bent, fit), _kappa(bent) - _kept(bent, fit), "o", color=WITH_FABRIC_COLOUR, markersize=4, alpha=0.6
    )
    one = bent[0]
    h = np.linspace(min(_h(bent)), max(_h(bent)) * 1.6, 200)
    factor = _STIFF_MODULUS_RATIO * bilayer_curvature(
        h, one.fabric_thickness_mm, _STIFF_MODULUS_RATIO, 1 - one.stretch**-2, fit.formula
    )
    curves = [
        bilayer_curvature(h, one.fabric_thickness_mm, p.modulus_ratio, 1 - one.stretch**-2, fit.formula)
        for p in _plastics(fit)
    ]
    axes.fill_between(factor, curves[1], curves[2], color=WITH_FABRIC_COLOUR, alpha=0.2, linewidth=0)
    axes.plot(factor, curves[0], color=WITH_FABRIC_COLOUR, linewidth=1.2)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    share = "6" if fit.formula == "paper" else "3"
    style_axes(axes, "curvature by the fabric, κ − κ_bar, 1/mm", f"{share} h2 (h1 + h2) / h1³ (1 − 1/s²), 1/mm")
    add_grid(axes)


def _plastics(fit: StripFit) -> list[Plastic]:
    """E1/E2 as fitted, and at both ends of its interval."""
    modulus_ratio = fit.ratio[fit.formula]
    return [
        fit.plastic(min(max(ratio, 1.0), 1e7)) for ratio in (modulus_ratio.value, modulus_ratio.low, modulus_ratio.high)
    ]


def _factor(readings: list[Reading], fit: StripFit) -> Floats:
    h2 = np.array([r.fabric_thickness_mm for r in readings])
    mismatch = 1 - np.array([r.stretch for r in readings]) ** -2
    return _STIFF_MODULUS_RATIO * bilayer_curvature(_h(readings), h2, _STIFF_MODULUS_RATIO, mismatch, fit.formula)


def _h(readings: list[Reading]) -> Floats:
    return np.array([r.thickness_mm for r in readings])


def _kappa(readings: list[Reading]) -> Floats:
    return np.array([r.curvature_per_mm or 0.0 for r in readings])


def _kept(readings: list[Reading], fit: StripFit) -> Floats:
    return residual_curvature(_h(readings), fit.plastic().kappa_bar_per_mm)
