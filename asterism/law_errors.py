"""How far a law is from cells that it was not made of, in one line for its users, where that is much."""

from __future__ import annotations

from homogenize.law import Law

MUCH = 5.0  # % rms over held-out cells
NAMED = {"kappa": "curvature", "bending": "bending stiffness"}


def coarse_line(law: Law) -> str | None:
    """What the law misses by much at a stretch, the worst one; None if it misses nothing, or was not tested."""
    found: list[tuple[float, str]] = []
    for stretch, kinds in law.residuals.items():
        errors = kinds["held_out"]["errors"]
        missed = {name: errors[name]["rms_percent"] for name in NAMED if name in errors}
        if max(missed.values(), default=0.0) > MUCH:
            words = " and ".join(f"{NAMED[name]} by {percent:.0f} %" for name, percent in missed.items())
            found.append(
                (max(missed.values()), f"at stretch {stretch} the law misses its own test cells' {words} (rms)")
            )
    return f"{max(found)[1]}: one of more sizes knows better" if found else None
