"""report.html of a fit: target and shape, distance, needed contraction, what remains; one self-contained file."""

from __future__ import annotations

from html import escape

from asterism.fitting.result import Fit
from asterism.reports.fit_plots import contraction_map, contraction_ranges, sections, signed_distance_map
from asterism.reports.fit_remainder import Remainder, remainder
from asterism.reports.fit_views import colour_limit, fit_views
from asterism.reports.html import figures, html_page, html_table, png, tiles, warnings_box
from asterism.reports.verification_page import design_rows
from asterism.results.records.fit import FitRecord, TargetDistanceRecord

PART_NAMES = {
    "stars": "what the stars leave, in the preview",
    "rounding": "rounding to the printer",
    "model": "exact model against preview",
    "bumps": "bumps of the stars",
}
STAGE_HEADER = ("distance, % of the diameter", "mean over a cell, rms", "with bumps, rms", "largest", "minimum")


def fit_page(fitted: Fit) -> str:
    """The whole page, as text."""
    s, name = fitted.summary, fitted.design.name
    rest = remainder(fitted)
    parts = [
        f"<h1>{escape(name)}</h1>",
        f'<p class="lead">{_verdict(s)}</p>',
        tiles(_headline(s)),
        f'<p class="small">{_how(s)}</p>',
        warnings_box("Limits of this fit", s.warnings),
        *_pictures(fitted),
        "<h2>What remains, and why</h2>",
        *_remains(rest, s),
        "<h2>Distance by stage</h2>",
        html_table(STAGE_HEADER, _stages(s)),
        f"<p>{_steps(s)}</p>",
        "<h2>The target</h2>",
        html_table(["", ""], _target(fitted), numbers=False),
        "<h2>The design</h2>",
        html_table(["", "as it is written, with defaults"], design_rows(s.design), numbers=False),
        f'<p class="small">asterism {escape(s.version)}</p>',
    ]
    return html_page(f"{name}: target and shape", parts)


def _result(s: FitRecord) -> TargetDistanceRecord:
    return s.exact or s.preview


def _verdict(s: FitRecord) -> str:
    result, by = _result(s), "exact shape" if s.exact else "preview"
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
    result = _result(s)
    loss = s.rounding_loss_percent
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
    far = colour_limit(fitted)
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
                (contraction_map(fitted), "needed on the print; red stars cannot contract so"),
                (contraction_ranges(fitted), "what each star needs, and the range that stars have"),
            ]
        ),
    ]


def _remains(rest: Remainder, s: FitRecord) -> list[str]:
    rows = [[PART_NAMES[name], f"{size:.2f}", sentence] for name, (size, sentence) in rest.parts.items()]
    total = f"{_result(s).surface_percent:.2f}"
    places = [[place, f"{size:.2f}"] for place, size in rest.places.items()]
    return [
        html_table(["part of the distance", "rms, %", "cause"], [*rows, ["all", total, ""]], numbers=False),
        '<p class="small">The squares of the parts add up to the square of the whole. A part that would be negative is '
        "left out; then the whole is smaller.</p>",
        html_table(["place", "mean over a cell, rms, %"], places),
        *(f"<p>{escape(sentence)}</p>" for sentence in rest.advice),
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
