"""The files of a fit, and its report.html: target and shape, distance, needed contraction, and what remains."""

from __future__ import annotations

from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from scipy.spatial import cKDTree

from asterism.draw.render import FABRIC_SIDE
from asterism.draw.scene import bare, scene
from asterism.draw.style import INK, PALE, RED, add_grid, style_axes
from asterism.equilibrium.arrays import Bools, Floats
from asterism.fitting.fit import Fit
from asterism.measure.compare import SIGNED_DISTANCE_COLOURS, frame_section, surface_cut
from asterism.pattern.design.errors import check_type
from asterism.pattern.geometry.planar import distance_to_outline
from asterism.reports.html import design_rows, figures, html_page, html_table, png, tiles, warnings_box
from asterism.reports.plots import ORANGE, PLOT_DPI, SLATE, aligned_views, png_of, print_figure, together
from asterism.reports.write_results import write_shape_files
from asterism.results.files import SUMMARY_FILE, staged_result
from asterism.results.records.fit import FitRecord


def write_fit(fitted: Fit, directory: str | Path) -> list[str]:
    """Write report.html, summary.json, target.obj, and shape.vtu, shape.obj and rods.vtu laid on the target.

    The shape is the exact one, or the preview if the exact model was not asked for. Its field `target_distance_mm` is
    the signed distance to the target. The target is written in the pose of the fit.

    The files appear together, or none of them if writing fails.

    Returns
    -------
    Their names.

    Raises
    ------
    OutputError
        They cannot be written there.
    """
    check_type(fitted, Fit, "fit makes them")
    distance = fitted.distance
    fields = {
        **distance.shape.point_fields,
        "target_distance_mm": distance.surface_mm,
        "mean_target_distance_mm": distance.mean_mm,
    }
    shape = replace(distance.shape, point_fields=fields)
    with staged_result(directory) as folder:
        write_shape_files(shape, folder)
        with (folder / "target.obj").open("w", encoding="ascii", newline="\n") as stream:
            stream.write("# target in the pose of the fit, mm\n")
            np.savetxt(stream, fitted.target.disk.vertices, "v %.6f %.6f %.6f")
            np.savetxt(stream, fitted.target.disk.triangles + 1, "f %d %d %d")
        # a name may hold characters that are not valid text
        (folder / "report.html").write_text(fit_page(fitted), encoding="utf-8", errors="backslashreplace")
        (folder / SUMMARY_FILE).write_text(fitted.summary.json_text())
        return sorted(file.name for file in folder.iterdir())


def fit_page(fitted: Fit) -> str:
    """The whole page, as text."""
    s, name = fitted.summary, fitted.design.name
    parts = [
        f"<h1>{escape(name)}</h1>",
        f'<p class="lead">{_verdict(s)}</p>',
        tiles(_headline(s)),
        f'<p class="small">{_how(s)}</p>',
        warnings_box("Limits of this fit", s.warnings),
        *_pictures(fitted),
        "<h2>What remains, and why</h2>",
        *_remains(fitted),
        "<h2>Distance by stage</h2>",
        html_table(
            ("distance, % of the diameter", "mean over a cell, rms", "with bumps, rms", "largest", "minimum"),
            _stages(s),
        ),
        f"<p>{_steps(s)}</p>",
        "<h2>The target</h2>",
        html_table(["", ""], _target(fitted), numbers=False),
        "<h2>The design</h2>",
        html_table(
            ["", "as it is written, with defaults; summary.json has long entries whole"],
            design_rows(s.design),
            numbers=False,
        ),
        f'<p class="small">asterism {escape(s.version)}</p>',
    ]
    return html_page(f"{name}: target and shape", parts)


def _verdict(s: FitRecord) -> str:
    result, by = (s.exact or s.preview), "exact shape" if s.exact else "preview"
    if not result.is_minimum:
        return (
            f'<span class="bad">No certified equilibrium.</span> The numbers show the state in which the {by} stopped.'
        )
    word = '<span class="good">Reached</span>' if s.reached else '<span class="bad">Not reached</span>'
    checked = "" if s.exact else " The exact model has not checked it."
    return (
        f"{word}: the {by} is {result.mean_percent:.2f} % of the diameter "
        f"({0.01 * result.mean_percent * s.diameter_mm:.2g} mm) away from the target, rms; the limit is "
        f"{s.within_percent:g} %.{checked}"
    )


def _headline(s: FitRecord) -> dict[str, str]:
    result, loss = s.exact or s.preview, s.rounding_loss_percent
    return {
        "distance, rms, mean over a cell": f"{result.mean_percent:.2f} %",
        "largest distance, with bumps": f"{result.largest_percent:.1f} %",
        "ratio of contractions: needed, available": f"{s.needed_ratio:.2f}, {s.available_ratio:.2f}",
        **({} if loss is None else {"loss by rounding to the printer": f"{loss:+.3f} %"}),
        "stars, held by": f"{s.stars}, {s.held_by}",
    }


def _how(s: FitRecord) -> str:
    laid = "" if s.needles or s.held_border else " The free sheet is first laid on the target."
    return (
        "Distances are those of places on the sheet from the nearest point of the target, positive on the plastic side."
        f"{laid} Percentages refer to the largest distance of two points of the target, {s.diameter_mm:.0f} mm. "
        "Means over a cell leave out the bumps of the stars. rms means root mean square. "
        "The distance to a real print has not been measured."
    )


def _pictures(fitted: Fit) -> list[str]:
    seen = {name: [png(image) for image in images] for name, images in fit_views(fitted).items()}
    by = "exact shape" if fitted.summary.exact else "preview"
    far = _colour_limit(fitted)
    return [
        "<h2>Target and shape</h2>",
        figures([(seen["target"][0], "target"), (seen["shape"][0], f"{by} of the design")]),
        "<h2>In one another</h2>",
        figures(
            [
                (seen["overlaid"][0], f"target orange, {by} blue; the outer surface is visible"),
                (seen["overlaid"][1], "from the front"),
                (seen["overlaid"][2], "from the side"),
            ]
        ),
        figures([(sections(fitted), "sections through the middle of the target")]),
        "<h2>Signed distance</h2>",
        figures(
            [
                (signed_distance_map(fitted), "on the print; points are needles, the cross is the largest distance"),
                (
                    seen["distance"][0],
                    f"on the {by}, from {far:.2g} mm below the target (blue) to {far:.2g} mm above (red)",
                ),
            ]
        ),
        "<h2>Contraction</h2>",
        figures(
            [
                (_contraction_map(fitted), "needed on the print; red stars cannot contract so"),
                (_contraction_ranges(fitted), "what each star needs, and the range that stars have"),
            ]
        ),
    ]


def _remains(fitted: Fit) -> list[str]:
    (parts, places, advice), s = remainder(fitted), fitted.summary
    rows = [[name, f"{size:.2f}", cause] for name, (size, cause) in parts.items()]
    total = f"{(s.exact or s.preview).surface_percent:.2f}"
    return [
        html_table(["part of the distance", "rms, %", "cause"], [*rows, ["all", total, ""]], numbers=False),
        '<p class="small">The squares of the parts add up to the square of the whole. A part that would be negative is '
        "left out; then the whole is smaller.</p>",
        html_table(["place", "mean over a cell, rms, %"], [[place, f"{size:.2f}"] for place, size in places.items()]),
        *(f"<p>{escape(sentence)}</p>" for sentence in advice),
    ]


def _stages(s: FitRecord) -> list[list[str]]:
    stages = {
        "first guess, preview": s.first_guess,
        "fit by the preview, not rounded": s.unrounded,
        "design as written, preview": s.preview,
        "design as written, exact shape": s.exact,
        "design as written, other exact minimum": s.other_exact,
    }
    return [
        [
            name,
            f"{record.mean_percent:.2f}",
            f"{record.surface_percent:.2f}",
            f"{record.largest_percent:.1f}",
            "yes" if record.is_minimum else "no",
        ]
        for name, record in stages.items()
        if record is not None
    ]


def _steps(s: FitRecord) -> str:
    forms = "" if s.exact_agrees is None else (
        " Both starts of the exact model lead to one minimum."
        if s.exact_agrees
        else " The two starts of the exact model lead to different minima; the lower one is shown."
    )  # fmt: skip
    again = (
        f" A fresh preview took another form {s.restarts} times, and the fit went on from there." if s.restarts else ""
    )
    corrected = f" {len(s.corrections)} exact shapes corrected it." if s.corrections else ""
    return f"{len(s.steps)} steps of the fit by the preview.{corrected}{again}{forms}"


def _target(fitted: Fit) -> list[list[str]]:
    s, disk = fitted.summary, fitted.target.disk
    return [
        ["file or name", s.target],
        ["largest distance of two points", f"{s.diameter_mm:.1f} mm"],
        ["triangles", str(len(disk.triangles))],
        *(["made coarser", note] for note in fitted.target.notes),
        [
            "largest curvature over a cell",
            f"{s.largest_curvature_per_mm:.4f} 1/mm, available {s.available_curvature_per_mm:.4f}",
        ],
        ["curved to the other side", f"{100 * s.wrong_side_share:.0f} % of the stars' places"],
        ["stars at the end of their range", f"{100 * s.share_at_bounds:.0f} %"],
    ]


def remainder(fitted: Fit) -> tuple[dict[str, tuple[float, str]], dict[str, float], list[str]]:
    """What remains of the distance of a fit, rms in % of the diameter.

    Returns
    -------
    Parts by name with their cause, whose squares add up to that of the distance; parts that vanish are left out. Places
    of the sheet with the distance there. One sentence for each place or limit that has most of the distance.
    """
    return _parts(fitted.summary), *_places(fitted)


def _parts(s: FitRecord) -> dict[str, tuple[float, str]]:
    stars, final = s.unrounded or s.preview, s.exact or s.preview
    cause = "The stars cannot come nearer: features smaller than a cell remain, and so does what supports do not hold."
    if s.needed_ratio > s.available_ratio:
        cause = (
            f"The target needs contractions of a ratio of {s.needed_ratio:.3f}, and stars give {s.available_ratio:.3f} "
            f"at stretch {s.stretch:g}. A larger stretch, a flatter target or a cut helps."
        )
    lost, between = _added(s.preview.mean_percent, stars.mean_percent), 0.0
    if s.exact is not None:
        between = _added(s.exact.mean_percent, s.preview.mean_percent)
        if s.corrections:  # then the loss by rounding is that of the exact shape
            unrounded = s.exact.mean_percent - (s.rounding_loss_percent or 0.0)
            lost, between = _added(s.exact.mean_percent, unrounded), _added(unrounded, stars.mean_percent)
    parts = {
        "what the stars leave, in the preview": (stars.mean_percent, cause),
        "rounding to the printer": (lost, "Thicknesses and widths are whole layers and lines of the printer."),
        "exact model against preview": (
            between,
            "The fit follows the preview, and the exact shape of the same design differs from it.",
        ),
        "bumps of the stars": (
            _added(final.surface_percent, final.mean_percent),
            "The bumps of the stars, which the mean over a cell leaves out.",
        ),
    }
    return {name: part for name, part in parts.items() if part[0]}


def _added(larger: float, smaller: float) -> float:
    """The part that is added to a distance, in quadrature; 0 if the distance does not grow."""
    return float(np.sqrt(max(larger**2 - smaller**2, 0.0)))


def _places(fitted: Fit) -> tuple[dict[str, float], list[str]]:
    shape, plan, s = fitted.shape, fitted.shape.layout, fitted.summary
    assert plan is not None
    # of the spacing: width of the rim, about the reach of one star
    rim_mm = 0.8 * fitted.guess.menu.spacing_mm
    in_rim = distance_to_outline(shape.printed, plan.outline) < rim_mm
    places = {f"within {rim_mm:.0f} mm of the outline": _rms(fitted, in_rim), "further inside": _rms(fitted, ~in_rim)}
    advice: list[str] = []
    rim, inside = places.values()
    # a part of the sheet has most of the distance if its rms is this many times that of the rest
    main = 1.5
    if rim > main * inside:
        advice.append("Most of the distance is at the rim." + (" More needles hold it." if s.needles else ""))
    ends = _stars_at_ends(fitted)
    if ends.any() and not ends.all():
        nearest = cKDTree(plan.centres).query(shape.printed)[1]
        at_end, elsewhere = _rms(fitted, ends[nearest]), _rms(fitted, ~ends[nearest])
        places |= {"around stars with the shortest or longest arms": at_end, "around other stars": elsewhere}
        if at_end > main * elsewhere:
            advice.append("Most of the distance is at stars whose arms are the shortest or longest of the law.")
    return places, advice


def _stars_at_ends(fitted: Fit) -> Bools:
    """(S,) whether a star has the shortest or the longest arms that the law covers."""
    plan, menu = fitted.shape.layout, fitted.guess.menu
    assert plan is not None
    low, high = menu.lengths_mm[0], menu.lengths_mm[-1]
    # of the range of lengths: sizes nearer to its ends count as at the end
    room = 1e-3 * (high - low)
    lengths = plan.star_sizes_mm[:, 0]
    return np.asarray((lengths < low + room) | (lengths > high - room))


def _rms(fitted: Fit, part: Bools) -> float:
    weights = fitted.shape.weights * part
    mean_square = weights @ fitted.distance.mean_mm**2 / max(weights.sum(), 1e-300)
    return float(100.0 * np.sqrt(mean_square) / fitted.distance.diameter_mm)


def signed_distance_map(fitted: Fit) -> bytes:
    """PNG of the signed distance over the print, mean over a cell; needles are points, a cross is at the largest."""
    figure, axes = _figure_with_needles(fitted)
    shape, far = fitted.shape, _colour_limit(fitted)
    mesh = Triangulation(shape.printed[:, 0], shape.printed[:, 1], shape.triangles)
    drawn = axes.tripcolor(
        mesh, fitted.distance.mean_mm, cmap=SIGNED_DISTANCE_COLOURS, vmin=-far, vmax=far, shading="gouraud"
    )
    figure.colorbar(drawn, label="mm; red: on the plastic side of the target", shrink=0.85, extend="both")
    worst = int(np.abs(fitted.distance.surface_mm).argmax())
    axes.plot(*shape.printed[worst], "X", color=INK, markersize=9, markeredgecolor="white")
    return png_of(figure)


def _contraction_map(fitted: Fit) -> bytes:
    """PNG of the contraction that each place of the print needs; stars whose law does not give it are red."""
    figure, axes = _figure_with_needles(fitted)
    target_map = fitted.guess.target_map
    triangles = target_map.flat.disk.triangles
    mesh = Triangulation(target_map.printed[:, 0], target_map.printed[:, 1], triangles)
    needed = np.exp(target_map.log_contraction)
    drawn = axes.tripcolor(mesh, needed, cmap=colormaps["viridis"], shading="gouraud")
    figure.colorbar(drawn, label="length in space over printed length", shrink=0.85)
    plan = fitted.shape.layout
    assert plan is not None
    here, low, high = star_contractions(fitted)
    outside = (here < low) | (here > high)
    axes.plot(*plan.centres[~outside].T, ".", color="white", markersize=4)
    axes.plot(*plan.centres[outside].T, "o", color=RED, markersize=5, markeredgecolor="white")
    return png_of(figure)


def _contraction_ranges(fitted: Fit) -> bytes:
    """PNG of the contraction that each star needs, over the range that stars have."""
    figure = Figure(figsize=(5.6, 3.6), dpi=PLOT_DPI, layout="constrained")
    axes = figure.subplots()
    here, low, high = star_contractions(fitted)
    order = np.argsort(here, kind="stable")
    rank, outside = np.arange(len(here)), ((here < low) | (here > high))[order]
    axes.axhspan(low, high, color="#cfd6e2", label="available")
    axes.plot(rank[~outside], here[order][~outside], "o", color=SLATE, markersize=3.5, label="needed")
    if outside.any():
        axes.plot(rank[outside], here[order][outside], "o", color=RED, markersize=4.5, label="not available")
    add_grid(axes)
    style_axes(axes, f"stretch {fitted.summary.stretch:g}", "stars, in the order of the needed contraction")
    axes.set_ylabel("length in space over printed length", fontsize=9, color=PALE)
    figure.legend(*axes.get_legend_handles_labels(), frameon=False, loc="outside upper right", ncols=3, fontsize=8)
    return png_of(figure)


def star_contractions(fitted: Fit) -> tuple[Floats, float, float]:
    """(S,) contraction that each star's place needs, and the smallest and the largest one of all stars."""
    plan, target_map = fitted.shape.layout, fitted.guess.target_map
    assert plan is not None
    needed = np.exp(target_map.interpolate(target_map.log_contraction, plan.centres))
    return needed, *fitted.guess.menu.range


def sections(fitted: Fit) -> bytes:
    """PNG of the sections of target and shape along x and y through the middle of the target."""
    both = np.concatenate([fitted.target.disk.vertices, fitted.shape.positions])
    width, depth, rise = np.ptp(both, axis=0)
    flatness = rise / max(min(width, depth), 1e-9)
    figure = Figure(figsize=(10.0, float(np.clip(1.2 + 5.0 * flatness, 1.8, 4.6))), dpi=PLOT_DPI, layout="constrained")
    for along, axes in enumerate(figure.subplots(1, 2)):
        _draw_section(axes, fitted, along)
    return png_of(figure)


def _draw_section(axes: Axes, fitted: Fit, along: int) -> None:
    """Draw the sections of target and shape along x (0) or y (1) through the middle of the target."""
    across = 1 - along
    disk, shape = fitted.target.disk, fitted.shape
    level = 0.5 * float(disk.vertices[:, across].min() + disk.vertices[:, across].max())
    parts: list[tuple[Any, Any, str, float]] = [
        (disk.vertices, disk.triangles, RED, 2.4),
        (shape.positions, shape.triangles, INK, 1.0),
    ]
    for positions, triangles, colour, width in parts:
        # a plane through rows of vertices would cut along edges
        segments = surface_cut(positions, triangles, across, level + 1e-6)[:, :, [along, 2]]
        axes.add_collection(LineCollection(list(segments), colors=colour, linewidths=width))
    both = np.concatenate([disk.vertices, shape.positions])[:, [along, 2]]
    frame_section(axes, both, f"cut along {'xy'[along]} through the middle: target red, shape black")


def _figure_with_needles(fitted: Fit) -> tuple[Figure, Axes]:
    plan = fitted.shape.layout
    assert plan is not None
    figure, axes = print_figure(plan)
    axes.plot(*plan.pin_points.T, "o", color=PALE, markersize=4)
    return figure, axes


def fit_views(fitted: Fit) -> dict[str, list[Floats]]:
    """Images (height, width, 4) by name, all with the same cameras and scale.

    - `target`, `shape`: alone, in perspective; the shape with its arms.
    - `overlaid`: the target in orange and the sheet in blue, in perspective, from the front and from the side.
    - `distance`: the sheet in the colours of its signed distance, red on the plastic side.
    """
    shape, disk = scene(fitted.shape), fitted.target.disk
    share = 0.5 + 0.5 * np.clip(fitted.distance.mean_mm / _colour_limit(fitted), -1.0, 1.0)
    target, sheet = bare(disk.vertices, disk.triangles, ORANGE), (fitted.shape.positions, fitted.shape.triangles)
    things = {
        "target": target,
        "shape": shape,
        "overlaid": together(bare(*sheet, FABRIC_SIDE), target),
        "distance": bare(*sheet, SIGNED_DISTANCE_COLOURS(share)[:, :3]),
    }
    return aligned_views(things, np.concatenate([shape.points, target.points]))


def _colour_limit(fitted: Fit) -> float:
    """The distance in mm at which the colours of signed distances end."""
    # colours end at this quantile of the distance, so that a few places at the rim do not make the rest pale
    # mm, smallest distance at which colours end
    return max(float(np.quantile(np.abs(fitted.distance.mean_mm), 0.98)), 0.05)
