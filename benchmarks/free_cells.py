"""Cells whose arms lie on no lattice lines: what their meshes cost in accuracy, and how much directions differ.

python -m benchmarks.free_cells [grid] [lengths] [directions]

Without a word all three tables are printed.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial

from asterism.homogenize.cell.sample import Sample, solve_cell
from asterism.homogenize.cell.tube_directions import ALL_ANGLES_RAD
from asterism.pattern.design.design import Design

STARS = ((10.0, 0.4), (10.0, 0.6), (7.0, 0.3))
EDGES = (1.92, 1.15)
# degrees, too little for arms to lie on lattice lines and too little to matter
OFF = 0.01
LENGTHS = np.arange(6.0, 8.6, 0.2)
NOISY = {"5 arms": {"arms": 5}, "3 arms turned by 10": {"orientation_deg": 10}}
DIRECTED = (
    ("5, triangular", {"arms": 5}, (5.0, 7.0, 9.0)),
    ("4, triangular", {"arms": 4}, (7.0,)),
    ("7, triangular", {"arms": 7}, (7.0,)),
    ("8, triangular", {"arms": 8}, (7.0,)),
    ("4, square", {"arms": 4, "kind": "square"}, (7.0,)),
    ("5, square", {"arms": 5, "kind": "square"}, (7.0,)),
    ("8, square", {"arms": 8, "kind": "square"}, (7.0,)),
)


def star(length: float, thickness: float, **lattice: Any) -> Design:
    """Equal stars of the paper's material."""
    sizes = {"length_mm": length, "thickness_mm": thickness}
    return Design.from_dict({"stars": sizes, "lattice": lattice, "border": {"rings": 1}})


def grid_table() -> None:
    """The free mesh against the aligned one, with stars turned by so little that only the mesh changes."""
    print("free mesh against the grid, three arms\n")
    print("| star, mm | edge mm | lambda % | kappa % | D % |\n| --- | ---: | ---: | ---: | ---: |")
    for length, thickness in STARS:
        for edge in EDGES:
            grid, free = (solve_cell(star(length, thickness, orientation_deg=turn), edge) for turn in (0.0, OFF))
            off = [_percent(f, g) for f, g in zip(_mean(free), _mean(grid), strict=True)]
            print(f"| h {thickness:g}, l {length:g} | {edge:g} | " + " | ".join(f"{x:+.2f}" for x in off) + " |")


def lengths_table() -> None:
    """How smooth the responses are over the length of the arms."""
    print("\noff a cubic over the length, 6 to 8.4 mm in steps of .2, h 0.4; rms and largest\n")
    print("| star | edge mm | lambda % | kappa % |\n| --- | ---: | ---: | ---: |")
    for name, lattice in NOISY.items():
        for edge in EDGES:
            rows = np.log([_mean(solve_cell(star(x, 0.4, **lattice), edge))[:2] for x in LENGTHS])
            off = np.array([100.0 * (row - Polynomial.fit(LENGTHS, row, 3)(LENGTHS)) for row in rows.T])
            cells = [f"{np.sqrt((x**2).mean()):.2f}, {np.abs(x).max():.2f}" for x in off]
            print(f"| {name} | {edge:g} | " + " | ".join(cells) + " |")


def directions_table() -> None:
    """Natural curvatures in six directions."""
    print("\nnatural curvature by direction, 1/mm, h 0.4, edges of 1.15 mm\n")
    print(
        "| arms, lattice | l mm | "
        + " | ".join(f"{np.degrees(a):.0f}" for a in ALL_ANGLES_RAD)
        + " | anisotropy % | asymmetry % |"
    )
    print("| --- | ---: |" + " ---: |" * 8)
    for name, lattice, lengths in DIRECTED:
        for length in lengths:
            found = solve_cell(star(length, 0.4, **lattice), 1.15)
            assert found.natural_curvature is not None and found.anisotropy is not None, found.failed
            assert found.asymmetry is not None
            values = " | ".join(f"{x:.4f}" for x in found.natural_curvature)
            ends = f"{100.0 * found.anisotropy:.1f} | {100.0 * found.asymmetry:.1f}"
            print(f"| {name} | {length:g} | {values} | {ends} |", flush=True)


TABLES = {"grid": grid_table, "lengths": lengths_table, "directions": directions_table}


def main(words: list[str]) -> None:
    """Print the tables."""
    for word in words or TABLES:
        TABLES[word]()


def _mean(found: Sample) -> tuple[float, float, float]:
    """Contraction, natural curvature and bending stiffness, means over the directions."""
    assert found.lam is not None and found.natural_curvature is not None and found.bending is not None, found.failed
    return found.lam, float(found.natural_curvature.mean()), float(found.bending.mean())


def _percent(one: float, other: float) -> float:
    return 100.0 * (one / other - 1.0)


if __name__ == "__main__":
    main(sys.argv[1:])
