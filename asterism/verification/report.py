"""report.html: preview and exact shape of a design, seen and in numbers, in one file that needs nothing else."""

from __future__ import annotations

import json
from collections.abc import Mapping
from html import escape
from typing import Any

from asterism.verification.html import figures, page, png, table, tiles
from asterism.verification.plots import distance_map, profiles
from asterism.verification.run import PREVIEW, RELEASE, Verification
from asterism.verification.views import views

NAMES = {RELEASE: "released from the flat print", PREVIEW: "started from the preview"}


def report(found: Verification) -> str:
    """The whole page, as text."""
    s, name = found.summary, found.design.name
    parts = [
        f"<h1>{escape(name)}</h1>",
        f'<p class="lead">{_verdict(s)}</p>',
        tiles(_headline(s)),
        _warnings(s["warnings"]),
        *_pictures(found),
        "<h2>Numbers</h2>",
        table(["", "exact", "preview", "difference"], _numbers(s)),
        "<h2>Minima seen</h2>",
        table(["exact model", "energy, N mm", "stars up", "minimum", "preview is away", "iterations"], _minima(s)),
        f"<p>{_agreement(s)}</p>",
        "<h2>Seconds</h2>",
        table(["", "s"], _seconds(s)),
        "<h2>The design</h2>",
        table(["", "as it was computed, with defaults"], _design(s["design"])),
        f"<footer>asterism {escape(s['version'])}. Distances are between the same printed points, after the best rigid "
        "motion, in % of the exact shape's diameter. Surfaces are compared by their means over a star's cell.</footer>",
    ]
    return page(f"{name}: preview and exact model", parts)


def _verdict(s: Mapping[str, Any]) -> str:
    branch = "the same form" if s["same_branch"] else '<span class="bad">another form</span>'
    expected = s["expected_rms_percent"]
    told = "" if expected is None else f", and had expected to be {expected:.1f} % off"
    return f"The preview shows {branch} as the exact model, {s['rms_percent']:.2f} % of the diameter away{told}."


def _headline(s: Mapping[str, Any]) -> dict[str, str]:
    radius, mesh = s["roll_radius_error_percent"], s["mesh_error_percent"]
    return {
        "distance of the surfaces, rms": _percent(s["rms_percent"], 2),
        "largest distance": _percent(s["max_percent"], 1),
        "distance of star centres, rms": _percent(s["rms_stars_percent"], 2),
        "height": _signed(s["height_error_percent"]),
        **({} if radius is None else {"radius of the roll": _signed(radius)}),
        "the exact model's mesh error": "not known" if mesh is None else _percent(mesh, 1),
        "the exact model, from the next coarser mesh": _percent(s["mesh_change_percent"], 1),
        "faster than the exact model": f"{s['speedup']:.0f} ×",
    }


def _warnings(lines: list[str]) -> str:
    each = "".join(f"<li>{escape(line)}</li>" for line in lines)
    return f'<ul class="warnings">{each}</ul>' if lines else ""


def _pictures(found: Verification) -> list[str]:
    seen = {name: [png(image) for image in images] for name, images in views(found.comparison).items()}
    largest = found.comparison.distance_mm.max()
    return [
        "<h2>Side by side</h2>",
        figures([(seen["exact"][0], "exact model"), (seen["preview"][0], "preview, with its stars' bumps")]),
        "<h2>One in the other</h2>",
        figures(
            [
                (seen["overlaid"][0], "exact blue, preview orange; what is outside is seen"),
                (seen["overlaid"][1], "from the side"),
                (seen["overlaid"][2], "from the front"),
            ]
        ),
        "<h2>Where the distance is</h2>",
        figures(
            [
                (distance_map(found.comparison), "over the print; dots are star centres"),
                (seen["distance"][0], f"on the exact shape, from none (light) to {largest:.1f} mm (dark)"),
            ]
        ),
        "<h2>Profiles through the middle</h2>",
        figures([(profiles(found.comparison), "cuts along straight lines of the print, each seen in its own plane")]),
    ]


def _numbers(s: Mapping[str, Any]) -> list[list[str]]:
    rows = [["height, mm", *_pair(s["heights_mm"], 1), _signed(s["height_error_percent"])]]
    if s["roll_radii_mm"] is not None:
        rows.append(["radius of the roll, mm", *_pair(s["roll_radii_mm"], 1), _signed(s["roll_radius_error_percent"])])
    if s["volumes_mm3"] is not None:
        cm3 = [volume / 1000.0 for volume in s["volumes_mm3"]]
        rows.append(["volume under the sheet, cm³", *_pair(cm3, 2), _signed(s["volume_error_percent"])])
    axes = ["-" if axis is None else f"{axis:.0f}" for axis in s["roll_axes_deg"]]
    return [
        *rows,
        ["axis of the roll on the print, deg", *axes, ""],
        ["normals, rms", "", "", f"{s['normals_rms_deg']:.1f}°"],
        ["surface, rms", "", "", _percent(s["rms_percent"], 2)],
        ["surface, largest", "", "", _percent(s["max_percent"], 2)],
        ["star centres, rms", "", "", _percent(s["rms_stars_percent"], 2)],
        ["star centres, largest", "", "", _percent(s["max_stars_percent"], 2)],
        ["diameter, mm", f"{s['diameter_mm']:.1f}", "", ""],
    ]


def _minima(s: Mapping[str, Any]) -> list[list[str]]:
    return [
        [
            NAMES[name] + (" (counts)" if name == s["result_from"] else ""),
            f"{one['energy_n_mm']:.4f}",
            str(one["stars_up"]),
            "yes" if one["is_minimum"] else "no",
            _percent(one["rms_percent"], 2),
            str(one["iterations"]),
        ]
        for name, one in s["starts"].items()
    ]


def _agreement(s: Mapping[str, Any]) -> str:
    if s["starts_agree"]:
        return "Both starts end in the same minimum."
    return f"The two starts end in different minima, {s['starts_distance_percent']:.1f} % of the diameter apart."


def _seconds(s: Mapping[str, Any]) -> list[list[str]]:
    names = {
        "preview_s": "preview, the first time",
        "preview_again_s": "preview, again",
        "exact_s": "exact model, " + NAMES[RELEASE],
        "exact_from_preview_s": "exact model, " + NAMES[PREVIEW],
    }
    return [[text, f"{s[key]:.3g}"] for key, text in names.items()]


def _design(design: Mapping[str, Any]) -> list[list[str]]:
    """A line for every entry; sections that were left out have none."""
    rows = []
    for name, value in design.items():
        entries = value if isinstance(value, Mapping) else {"": value}
        for key, entry in entries.items():
            if entry not in (None, [], {}):
                rows.append([f"{name}.{key}".rstrip("."), json.dumps(entry, ensure_ascii=False)])
    return rows


def _pair(values: list[float], digits: int) -> list[str]:
    return [f"{value:.{digits}f}" for value in values]


def _percent(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f} %"


def _signed(value: float | None) -> str:
    return "-" if value is None else f"{value:+.1f} %"
