"""How far a law is from cells that it was not made of, its cells from themselves on another mesh, and from stability.

Each in one line, if it is much.
"""

from __future__ import annotations

from typing import Any

from homogenize.law.law import Law

MAX_HELD_OUT_ERROR_PERCENT = 5.0  # % rms over held-out cells
MAX_MESH_DIFFERENCE_PERCENT = 25.0  # % between two meshes of a cell; cells of three-armed stars stay below 12 %
MAX_UNSTABLE_SHARE = 0.1  # part of the cells; of the paper's law 1.4 %, all of them tight
CHECKED_QUANTITIES = {"kappa": "curvature", "bending": "bending stiffness"}


def held_out_warning(law: Law) -> str | None:
    """What the law misses by much at a stretch, the worst one; None if it misses nothing, or was not tested."""
    found: list[tuple[float, str]] = []
    for stretch, kinds in law.residuals.items():
        errors = kinds["held_out"]["errors"]
        missed = {name: errors[name]["rms_percent"] for name in CHECKED_QUANTITIES if name in errors}
        if max(missed.values(), default=0.0) > MAX_HELD_OUT_ERROR_PERCENT:
            words = " and ".join(f"{CHECKED_QUANTITIES[name]} by {percent:.0f} %" for name, percent in missed.items())
            found.append(
                (max(missed.values()), f"at stretch {stretch} the law misses its own test cells' {words} (rms)")
            )
    return f"{max(found)[1]}: one of more sizes knows better" if found else None


def mesh_warning(law: Law) -> str | None:
    """Which cell curls otherwise on another mesh, the worst one; None if none does, or each was solved on one."""
    cells: list[dict[str, Any]] = [kinds.get("meshes", {}) for kinds in law.residuals.values()]
    worst = max(cells, key=lambda each: each.get("largest_percent", 0.0), default={})
    if worst.get("largest_percent", 0.0) <= MAX_MESH_DIFFERENCE_PERCENT:
        return None
    sizes = "l {length_mm:.4g}, h {thickness_mm:.4g}, w {width_mm:.4g} mm".format(**worst)
    percent = worst["largest_percent"]
    differ = "curls to the other side" if percent > 100.0 else f"curls by {percent:.0f} % more or less"
    return f"the law's cell of {sizes} {differ} on another mesh: its edges are too long to know how such stars curl"


def pleat_warning(law: Law) -> str | None:
    """How many cells would leave their natural tubes, if many: neighbours that need not be alike rise and fall."""
    tubes = [kinds["tubes"] for kinds in law.residuals.values() if "tubes" in kinds]
    count, unstable = (sum(each[name] for each in tubes) for name in ("count", "unstable"))
    if unstable <= MAX_UNSTABLE_SHARE * count:
        return None
    return (
        f"the natural tubes of {unstable} of the law's {count} cells are not stable where neighbouring stars may "
        "differ: their sheets may pleat, which a smooth sheet cannot show"
    )
