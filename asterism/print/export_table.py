"""What `asterism export` prints at its end."""

from __future__ import annotations

from typing import Any

from asterism.print.needles import VISIBLE_SAG_MM, needle_names, sag_in_words

_MOST_NAMED = 4


def export_rows(s: dict[str, Any]) -> dict[str, str]:
    """Rows by name, from what `write_export` returns."""
    rounding, cost = s["rounding"], s["estimate"]
    rows = {"printer": f"{s['printer']['name']}, {s['plastic']['name']}"}
    for name in ("thickness", "width"):
        rows[name] = _sizes(rounding[name], s["stars"])
    rows["layers"] = f"first {rounding['first_layer_mm']:g} mm, then {rounding['layer_mm']:g} mm"
    if better := rounding["better_layers"]:
        options = f"--first-layer {better['first_layer_mm']:g} --layer {better['layer_mm']:g}"
        rows["better layers"] = f"{options} is nearer to the design"
    rounded = rounding["thickness"]["stars_changed"] or rounding["width"]["stars_changed"]
    rows["change of shape"] = _change(s["shape_change"]) if rounded else "none"
    if tiny := s["tiny_stars"]:
        places = ", ".join(f"[{x:g}, {y:g}]" for x, y in (star["at_mm"] for star in tiny[:_MOST_NAMED]))
        rows["tiny stars"] = f"{len(tiny)}, may jump off: at {places}" + (", ..." if len(tiny) > _MOST_NAMED else "")
    if not s["printed_border"]:
        rows["cut line"] = "not printed, in layout.pdf"
    fabric = "stretched fabric" if s["fabric_given"] else "released fabric; measure it stretched: --fabric"
    rows["z offset"] = f"{s['z_offset_mm']:.2f} mm (plate and {fabric}), in start.gcode"
    before, (x, y) = s["check_square_mm"]["before"][0], s["check_square_mm"]["after"]
    rows["check square"] = f"{before:g} mm before stretching, {x:.1f} x {y:.1f} mm after"
    rows["needles"] = str(s["needles"])
    if through := s["needles_in_plastic"]:
        rows["in plastic"] = f"{needle_names(through)}: drill the arm there, or move the pin"
    if s["hangs_below_base_mm"] is None:
        rows["hangs"] = "not known without a law for this fabric; --simulate says it"
    elif s["hangs_below_base_mm"] > VISIBLE_SAG_MM:
        rows["hangs"] = (
            f"{sag_in_words(s['hangs_below_base_mm'], s['hangs_doubt_mm'])}: set needles higher, or cut it out"
        )
    rows["estimate"] = f"{cost['minutes']:.0f} min, {cost['mass_g']:.2f} g, {cost['filament_m']:.2f} m"
    return rows


def _sizes(sizes: dict[str, Any], stars: int) -> str:
    values = ", ".join(f"{value:g}" for value in sizes["values_mm"])
    if not sizes["stars_changed"]:
        return f"{values} mm, as drawn"
    most = sizes["largest_change_mm"]
    return f"{values} mm; {sizes['stars_changed']} of {stars} stars rounded, by {most:+.3f} mm at most"


def _change(change: dict[str, Any] | None) -> str:
    if change is None:
        return "not computed"
    if change["model"] is None:
        return f"not computed ({change['why']}); --simulate does"
    before, after = change["height_mm"]
    distance = f"{change['star_distance_mm']:.2f} mm ({change['star_distance_percent']:.1f} % of the diameter)"
    by = "exact model" if change["model"] == "exact" else "preview; --simulate is exact"
    if change["stars_outside_law"]:
        unknown = change["stars_outside_law"]
        by = f"not to be trusted: the preview's law does not know {unknown} of the stars; --simulate is exact"
    return f"{distance}, height {before:.2f} -> {after:.2f} mm ({by})"
