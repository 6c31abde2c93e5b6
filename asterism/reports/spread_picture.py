"""The picture of the range of shapes: a line through the highest point with its band, and what each value changes."""

from __future__ import annotations

from pathlib import Path
from typing import IO

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from asterism.draw.fonts import write_title
from asterism.draw.style import INK, PALE, add_grid, style_axes
from asterism.results.records.spread import VALUES, SpreadRecord

BAND_COLOUR = "#2a6f97"
BAR_COLOUR = "#9fbdd0"


def draw_spread(record: SpreadRecord, name: str, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw the range of shapes of a design as PNG."""
    figure = Figure(figsize=(10, 4.2), dpi=150, facecolor="white")
    FigureCanvasAgg(figure)
    side, bars = figure.subplots(1, 2, width_ratios=(1.5, 1.0))
    figure.subplots_adjust(left=0.06, right=0.98, bottom=0.13, top=0.74, wspace=0.42)
    low, median, high = (np.array(line) for line in (record.line_low_mm, record.line_median_mm, record.line_high_mm))
    side.fill(*np.concatenate([low, high[::-1]]).T, color=BAND_COLOUR, alpha=0.2, linewidth=0)
    for line, width in ((low, 0.6), (median, 1.6), (high, 0.6)):
        side.plot(*line.T, color=BAND_COLOUR, linewidth=width)
    side.set_aspect("equal", adjustable="datalim")
    style_axes(side, "through the highest point, mm: nine of ten prints", "along the ground, mm")
    add_grid(side)
    for row, share in enumerate(reversed(record.shares)):
        ends = share.heights_mm
        bars.barh(row, np.ptp(ends), left=min(ends), height=0.6, color=BAR_COLOUR)
        bars.plot(ends[1], row, "o", color=BAND_COLOUR, markersize=4)
    bars.use_sticky_edges = False
    bars.axvline(record.height_median_mm, color=INK, linewidth=0.8)
    bars.set_yticks(range(len(record.shares)), [VALUES[share.value] for share in reversed(record.shares)])
    style_axes(bars, "height by each value alone; dots: upper end", "height, mm")
    add_grid(bars)
    write_title(figure, 0.012, 0.92, name, 14)
    figure.text(0.012, 0.86, record.range_in_words, fontsize=10, color=INK)
    if record.best_measurement is not None:
        figure.text(0.012, 0.81, f"measure {record.best_measurement}", fontsize=10, color=PALE)
    figure.savefig(path_or_file, format="png", dpi=150)
