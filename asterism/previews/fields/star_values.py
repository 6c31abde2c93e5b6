"""What the law says of a layout's stars, and what it refuses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asterism.previews.fields.directional import strongest
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from homogenize.errors import LawError
from homogenize.law.hermite_grid import Bools
from homogenize.law.law import Law
from homogenize.law.law_table import MAX_SEPARATED_CURL, QUANTITY_NAMES
from pattern.design.design import Design
from pattern.geometry.arrays import Floats
from pattern.layout.layout import Layout


@dataclass(frozen=True)
class StarValues:
    """The law at S stars and at the bare fabric.

    Attributes
    ----------
    value : for each of the law's quantities (S + 1,); the last is the bare fabric's. `c3` is `max_sixfold_share` of
        `bending/|kappa|` at most.
    relief : (S + 1, 2, W) mm and mm^2, amplitudes of the law's waves: flat, and more per curvature.
    sizes : (S, 3) mm, length, thickness and width that the law was asked for.
    outside : one line for each star beyond the law's range; it counts as the nearest star in the range.
    tight : numbers of the stars whose sheet would curl to a radius below two thirds of their spacing, in the mean over
        directions or around the tube that gains most with all of what differs between them.
    uneven : numbers of the stars whose `c3` was more than that: they curl to one side in some directions, and to the
        other, or hardly, elsewhere.
    tips : (S + 1, 2) mm and mm^2, the relief at the tips of a star's arms, mean over the arms: flat, and more per
        curvature.
    curl : (S + 1,) 1/mm, natural curvature of the tube that gains most: `kappa`, unless directions differ.
    anisotropy : (S + 1, K) what differs between directions, `anisotropy_share` of `homogenize.law.anisotropy`;
        mostly K = 0.
    caps : (S + 1,) 1/mm, curvature `2 B / l^2` of a star's bump of height B over arms of length l, on its natural tube.
    """

    value: dict[str, Floats]
    relief: Floats
    sizes: Floats
    outside: tuple[str, ...]
    tight: tuple[int, ...]
    uneven: tuple[int, ...]
    tips: Floats
    caps: Floats
    curl: Floats
    anisotropy: Floats


def star_sizes(layout: Layout, arms: int) -> Floats:
    """(S, 3) mm, mean length, thickness and width of each star's arms; arms that were cut away count as length 0."""
    star, count = layout.arm_star, len(layout.centres)
    length = np.bincount(star, layout.arm_length, count) / arms
    share = layout.arm_length / (arms * length[star])
    thickness, width = (
        np.bincount(star, share * ends.mean(axis=1), count) for ends in (layout.arm_thickness, layout.arm_width)
    )
    return np.column_stack([length, thickness, width])


def star_values(design: Design, layout: Layout, law: Law, model: PreviewModel = PREVIEW_MODEL) -> StarValues:
    """The law at every star of a design.

    Raises
    ------
    LawError
        The law is for another material, stretch or lattice, or asks for something impossible at a star.
    """
    sizes = star_sizes(layout, design.lattice.arms)
    asked = np.vstack([sizes, [0.0, *np.mean(sizes[:, 1:], axis=0)]])
    found = law.evaluate(design, *asked.T)
    where = [
        f"star {number} at [{x:.1f}, {y:.1f}]"
        for number, (x, y) in zip(layout.star_number, layout.centres, strict=True)
    ]
    _check(where, {name: found.value[name][:-1] for name in QUANTITY_NAMES})
    outside = tuple(_placed(line, where) for line in found.outside)
    differs = law.anisotropy(design, *asked.T)
    anisotropy = model.anisotropy_share * differs
    curl = strongest(found.value["kappa"], anisotropy)
    # tight are those whose cells are
    curls = found.tight | (
        np.abs(strongest(found.value["kappa"], differs)) * design.lattice.spacing_mm > MAX_SEPARATED_CURL
    )
    tight = tuple(layout.star_number[curls[:-1]].tolist())
    relief = law.relief(design, *asked.T)
    tips, caps = _bumps(design, law, asked[:, 0], relief, found.value["kappa"], model)
    c3, too_much = _bounded_sixfold(found.value, model.max_sixfold_share)
    uneven = tuple(layout.star_number[too_much[:-1]].tolist())
    return StarValues(found.value | {"c3": c3}, relief, sizes, outside, tight, uneven, tips, caps, curl, anisotropy)


def _bounded_sixfold(value: dict[str, Floats], max_share: float) -> tuple[Floats, Bools]:
    """(n,) `c3` as far as the bending stiffness bears it, and (n,) where it is more."""
    c3, most = value["c3"], max_share * value["bending"]
    taken = np.abs(c3 * value["kappa"])
    too_much = taken > most
    return np.where(too_much, c3 * most / np.where(too_much, taken, 1.0), c3), too_much


def _bumps(
    design: Design, law: Law, length: Floats, relief: Floats, kappa: Floats, model: PreviewModel
) -> tuple[Floats, Floats]:
    """`tips` and `caps` of stars with arms of a length (n,) mm, relief (n, 2, W) and natural curvature (n,)."""
    lattice = design.lattice
    reach = np.minimum(length, model.cell_radius * lattice.spacing_mm)
    arms = np.asarray(lattice.arm_directions)
    waves = law.waves((reach[:, None] * arms[:, None]).reshape(-1, 2)).reshape(len(arms), len(reach), -1)
    tips = np.einsum("nkw,nw->nk", relief, waves.mean(axis=0))
    tops = relief @ law.waves(np.zeros((1, 2)))[0]
    flat, more = (tops - tips).T
    caps = 2.0 * (flat + kappa * more) / np.maximum(reach, model.min_bump_radius * lattice.spacing_mm) ** 2
    return tips, np.where(length > 0.0, caps, 0.0)


def _placed(line: str, where: Sequence[str]) -> str:
    """The law's words on a star, with its place."""
    head, text = line.split(": ", 1)
    return f"{where[int(head.split()[1])]}: {text}"


def _check(where: Sequence[str], value: dict[str, Floats]) -> None:
    """Refuse what no sheet can do, whatever file the law comes from; values (S,) of stars that are somewhere."""
    lam, bending, a11 = value["lam_n"], value["bending"], value["a11"]
    allowed = {
        "lam_n": ((lam > 0.0) & (lam <= 1.0), "a contraction above 0 and up to 1"),
        "kappa": (np.isfinite(value["kappa"]), "a finite natural curvature"),
        "bending": ((bending > 0.0) & (bending < np.inf), "a positive bending stiffness"),
        "a11": ((np.abs(value["a12"]) < a11) & (a11 < np.inf), "a positive membrane stiffness"),
    }
    wrong = ~np.array([fine for fine, _ in allowed.values()])
    if wrong.any():
        star = int(wrong.any(axis=0).argmax())
        name, (_, what) = list(allowed.items())[int(wrong[:, star].argmax())]
        raise LawError(f"{where[star]}: the law's {name} = {value[name][star]:.4g}, a sheet needs {what}")
