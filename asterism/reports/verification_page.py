"""report.html of a verification: pictures and numbers of preview and exact shape, in one self-contained file."""

from __future__ import annotations

from html import escape
from pathlib import Path

from asterism.pattern.design.errors import check_type
from asterism.print.formats.meshes import write_shape_obj
from asterism.reports.html import design_rows, figures, html_page, html_table, png, tiles, warnings_box
from asterism.reports.plots import comparison_views, distance_map, profiles
from asterism.results.files import SUMMARY_FILE, staged_result
from asterism.results.records.verification import VerificationRecord
from asterism.results.words import direction, height_error, times
from asterism.shape.vtu import write_shape_vtu
from asterism.verification.verify import FLAT_HEIGHT_FACTOR, PREVIEW, RELEASE, Verification


def write_verification(verification: Verification, directory: str | Path) -> list[str]:
    """Write report.html, summary.json, and exact and preview (laid on the exact shape) as .vtu and .obj.

    The files appear together, or none of them if writing fails.

    Returns
    -------
    Their names.

    Raises
    ------
    OutputError
        They cannot be written there.
    """
    check_type(verification, Verification, "verify makes them")
    with staged_result(directory) as folder:
        # the command line may hold file names that are not valid text
        (folder / "report.html").write_text(
            verification_page(verification), encoding="utf-8", errors="backslashreplace"
        )
        compared = {"exact": verification.comparison.reference, "preview": verification.comparison.other}
        for name, shape in compared.items():
            write_shape_vtu(shape, folder / f"{name}.vtu")
            write_shape_obj(folder / f"{name}.obj", shape, f"{verification.design.name}, {name}")
        (folder / SUMMARY_FILE).write_text(verification.summary.json_text())
        return sorted(file.name for file in folder.iterdir())


def verification_page(verification: Verification) -> str:
    """The whole page, as text."""
    s, name = verification.summary, verification.design.name
    seen = s.table()
    parts = [
        f"<h1>{escape(name)}</h1>",
        f'<p class="lead">{_verdict(s)}</p>',
        tiles(_headline(s)),
        f'<p class="small">{_how(s)}</p>',
        warnings_box("Before you trust these numbers", s.warnings),
        *_pictures(verification),
        "<h2>Numbers</h2>",
        html_table(["", "exact", "preview", "difference"], _numbers(s)),
        f"<p>Mesh error of the exact shape: {escape(seen['exact mesh error'])}.</p>",
        "<h2>Minima seen</h2>",
        html_table(
            ["exact model", "energy, N mm", "stars up", "certified", "distance of the preview", "iterations", "s"],
            _minima(s),
        ),
        f"<p>{escape(seen['exact model'])}.</p>",
        "<h2>The design</h2>",
        html_table(
            ["", "as computed, with defaults; summary.json has long entries whole"],
            design_rows(s.design),
            numbers=False,
        ),
        "<h2>Other inputs</h2>",
        html_table(["", ""], _origins(s), numbers=False),
    ]
    return html_page(f"{name}: preview and exact model", parts)


def _verdict(s: VerificationRecord) -> str:
    if not s.exact.is_minimum:
        return (
            'The exact model has <span class="bad">not found a certified equilibrium</span>. Therefore the preview '
            "cannot be judged. Pictures and numbers show the state in which the exact model stopped."
        )
    branch = "the same form as" if s.same_branch else '<span class="bad">another form</span> than'
    expected = s.expected_rms_percent
    estimate = "" if expected is None else f" Its estimated error is {expected:.1f} %."
    distance = f"{s.rms_percent:.2f} % of the diameter ({s.rms_mm:.2g} mm)"
    return f"The preview shows {branch} the exact model, at an rms distance of {distance}.{estimate}"


def _how(s: VerificationRecord) -> str:
    """An explanation of the numbers for readers who do not know the documentation."""
    # how the preview is laid on the exact shape, by the number of rigid motions that the supports leave free
    motions = {
        0: "with both shapes in space as their supports hold them",
        6: "after the preview is rotated and shifted onto the exact shape",
    }.get(s.free_motions, "after the preview is rotated and shifted as far as the supports allow")
    relief, it = ("the bumps of the stars", "them") if _has_stars(s) else ("their relief", "it")
    return (
        f"Distances are measured between the positions of the same printed points, {motions}. "
        f"Percentages refer to the diameter of the exact shape, {s.diameter_mm:.0f} mm. Surfaces are compared without "
        f"{relief} (means over a cell of the lattice), {_points(s)} with {it}. rms means root mean square. Accuracy "
        "means agreement with the exact model. The distance to a real print has not been measured."
    )


def _has_stars(s: VerificationRecord) -> bool:
    return bool(s.preview.get("stars", 1))


def _points(s: VerificationRecord) -> str:
    """The places of the second comparison."""
    return "star centres" if _has_stars(s) else "lattice sites"


def _headline(s: VerificationRecord) -> dict[str, str]:
    if not s.exact.is_minimum:
        return {}
    values = {
        "distance of the surfaces, rms": _percent(s.rms_percent, 2),
        "largest distance": _percent(s.max_percent, 1),
        f"distance of {_points(s)}, rms": _percent(s.rms_stars_percent, 2),
        "height error of the preview": "-" if _is_flat(s) else _signed(s.height_error_percent),
        "error of the rise over the supports": _signed(s.rise_error_percent),
        "error of the roll radius": _signed(s.roll_radius_error_percent),
        "mesh error of the exact model": _percent(s.mesh_error_percent, 1),
        f"{'faster than' if s.speedup > 1.0 else 'as fast as'} the exact model": f"{times(s.speedup)} ×",
    }
    return {name: text for name, text in values.items() if text != "-"}


def _is_flat(s: VerificationRecord) -> bool:
    """Whether both sheets are nearly flat, so that the ratio of their heights has no meaning."""
    exact, preview = s.heights_mm
    return bool(abs(preview - exact) < FLAT_HEIGHT_FACTOR * s.diameter_mm and abs(s.height_error_percent or 0.0) > 50.0)


def _pictures(verification: Verification) -> list[str]:
    seen = {name: list(map(png, images)) for name, images in comparison_views(verification.comparison).items()}
    largest = verification.comparison.distance_mm.max()
    of_preview = "preview, with the bumps of its stars" if _has_stars(verification.summary) else "preview"
    return [
        "<h2>Side by side</h2>",
        figures([(seen["exact"][0], "exact model"), (seen["preview"][0], of_preview)]),
        "<h2>Both shapes together</h2>",
        figures(
            [
                (seen["overlaid"][0], "exact blue, preview orange; the outer surface is visible"),
                (seen["overlaid"][1], "from the front"),
                (seen["overlaid"][2], "from the side"),
            ]
        ),
        "<h2>Distance over the sheet</h2>",
        figures(
            [
                (distance_map(verification.comparison), f"over the print; dots are {_points(verification.summary)}"),
                (seen["distance"][0], f"on the exact shape, from 0 (light) to {largest:.1f} mm (dark)"),
            ]
        ),
        "<h2>Profiles through the middle</h2>",
        figures(profiles(verification.comparison)),
        '<p class="small">Cuts along straight lines of the print, each in its own plane.</p>',
    ]


def _numbers(s: VerificationRecord) -> list[list[str]]:
    pairs = {
        "height, mm": (s.heights_mm, "" if _is_flat(s) else _signed(s.height_error_percent)),
        "rise over the supports, mm": (s.rises_mm, _signed(s.rise_error_percent)),
        "radius of the roll, mm": (s.roll_radii_mm, _signed(s.roll_radius_error_percent)),
        "volume under the sheet, cm³": (
            s.volumes_mm3 and [volume / 1000.0 for volume in s.volumes_mm3],
            _signed(s.volume_error_percent),
        ),
    }
    rows = [[name, *(f"{value:.4g}" for value in pair), off] for name, (pair, off) in pairs.items() if pair is not None]
    axes = ["-" if axis is None else direction(axis) for axis in s.roll_axes_deg]
    if axes != ["-", "-"]:
        itself, laid = s.preview.get("roll_axis_deg"), ""
        if itself is not None and direction(itself) != axes[1]:
            laid = f" (of the preview before the rigid motion: {direction(itself)})"
        rows.append([f"axis of the roll on the print, deg{laid}", *axes, ""])
    high, moved = s.expected_height_percent, s.rms_after_motion_percent if s.free_motions < 6 else None
    single = {
        "normals, rms": f"{s.normals_rms_deg:.1f}°",
        "surface, rms": _percent(s.rms_percent, 2),
        "surface, rms, after the best rigid motion, which the supports prevent": _percent(moved, 2),
        "surface, largest": _percent(s.max_percent, 2),
        f"{_points(s)}, rms": _percent(s.rms_stars_percent, 2),
        f"{_points(s)}, largest": _percent(s.max_stars_percent, 2),
        "bumps, rms, relative to their size": _percent(s.relief_error_percent, 0),
        "surface, rms, estimated by the preview": _percent(s.expected_rms_percent, 2),
        "height, estimated by the preview": "-" if high is None else height_error(high, s.heights_mm[1]),
    }
    rows += [[name, "", "", text] for name, text in single.items() if text != "-"]
    return [*rows, ["diameter, mm", f"{s.diameter_mm:.1f}", "", ""]]


def _minima(s: VerificationRecord) -> list[list[str]]:
    starts = {RELEASE: "released from the flat print", PREVIEW: "started from the preview"}
    return [
        [
            starts[name] + (" (result)" if name == s.result_from else ""),
            f"{one.energy_n_mm:.4f}",
            str(one.stars_up),
            "yes" if one.is_minimum else "no",
            _percent(one.rms_percent, 2),
            str(one.iterations),
            f"{s.exact_s if name == RELEASE else s.exact_from_preview_s:.3g}",
        ]
        for name, one in s.starts.items()
    ]


def _origins(s: VerificationRecord) -> list[list[str]]:
    """Rows of a table. The law is missing if another shape replaced the preview."""
    preview, exact = s.preview, s.exact
    rows = [["command", s.command]] if s.command else []
    if law := preview.get("law"):
        made = f", made by {law['made_by']}" if law["made_by"] else ""
        what = f"{law['material']}, fabric stretched {law['stretch']:g}, edges of {law['edge_mm']:g} mm{made}"
        rows.append(["law", what])
    shell = f"{preview['shell_triangles']} triangles, side {preview['side']}, " if "shell_triangles" in preview else ""
    rows.append(["preview", f"{shell}{s.preview_s:.3g} s without compilation of loops"])
    mesh = f"edges of {exact.edge_mm:g} mm, {exact.triangles} triangles ({exact.mesh} mesh)"
    rows.append(["exact model", f"{mesh}, fabric bending {exact.fabric_bending}, solver {exact.backend}"])
    return [*rows, ["asterism", s.version]]


def _percent(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f} %"


def _signed(value: float | None) -> str:
    return "-" if value is None else f"{value:+.1f} %"
