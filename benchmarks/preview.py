"""The preview's cost: the shell on 24, 96 and 384 triangles beside scikit-fem's own assembler, and whole designs.

python -m benchmarks.preview [shell|designs ...]

Wall times are medians, on two cores; processor times stand beside them, as other programs disturb them less. How many
programs wanted the cores meanwhile is said above the tables. Edits change a size of all stars by 1 or 2 %, and back.
A cold process imports everything and loads compiled loops. All other previews are warm: of a new print, which the
process has not previewed before, or again of the same print, whose mesh and supports are kept.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from skfem import Basis, BilinearForm, ElementTriArgyris, ElementVector, MeshTri

from asterism.exact.simulation import exact_shape
from asterism.fem.search.initial_guesses import initial_guesses
from asterism.fem.search.linear_response import linear_response
from asterism.fem.search.mixed_newton import mixed_newton
from asterism.fem.search.relax import GRADIENT_TOLERANCE, follow
from asterism.fem.shell.density import isotropic
from asterism.fem.shell.shell import QUADRATURE_ORDER, Shell
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.previews.default_law import paper_law
from asterism.previews.kept_prints import forget_prints
from asterism.previews.session import Preview
from benchmarks.report import markdown, write_report

TRIANGLES = [54, 96, 384]
DESIGNS = ["tube", "dome", "u-shape"]
REPEATS = 5
# what is edited, and back: a size of all stars times a share
EDITS = [(size, share) for size in ("thickness_mm", "width_mm") for share in (0.98, 0.99, 1.01, 1.02)]
COLD = "import time, asterism; asterism.preview(asterism.new({name!r})); print(time.process_time())"
SHELL = [
    "triangles", "unknowns", "strains", "tangent", "factorisation", "linear response", "scikit-fem tangent", "ratio",
    "iterations", "equilibrium", "equilibrium by the clock",
]  # fmt: skip
WHOLE = [
    "design", "stars", "triangles", "cold s", "cold processor s", "new print ms", "new print processor ms",
    "again ms", "again processor ms", "equilibrium ms", "edit ms", "edit processor ms", "slowest edit ms",
    "linear response ms", "its solve ms", "exact s", "exact / new print", "exact, law's mesh s", "that / new print",
    "that / edit",
]  # fmt: skip


def timed(work: Callable[[], Any], repeats: int = REPEATS) -> tuple[float, float]:
    """Medians of wall and processor milliseconds, after one run that does not count."""
    work()
    wall, processor = [], []
    for _ in range(repeats):
        begin, used = time.perf_counter(), time.process_time()
        work()
        wall.append(time.perf_counter() - begin)
        processor.append(time.process_time() - used)
    return 1e3 * statistics.median(wall), 1e3 * statistics.median(processor)


def shell_row(triangles: int) -> dict[str, Any]:
    """The tube's shell on a mesh of so many triangles."""
    preview = Preview(gallery.load("tube"), triangles=triangles)
    shell, found = preview.shell, preview.equilibrium
    factor = shell.factor()
    data = shell.hessian(found.x)
    data[shell.pattern.diagonal] += 1e-6 * data.max()
    start = _rolled(preview)
    tolerance = GRADIENT_TOLERANCE * shell.force_scale
    run = mixed_newton(shell, start, factor, tolerance)
    wall, processor = timed(lambda: mixed_newton(shell, start, factor, tolerance))
    follow(shell, found.x, factor)
    own = timed(lambda: shell.tangent(found.x, np.asarray(shell.density.stiffness), np.zeros_like(found.strains)))[1]
    theirs = scikit_fem_ms(shell)
    return {
        "triangles": shell.space.mesh.nelements,
        "unknowns": shell.pattern.size,
        "strains_ms": timed(lambda: shell.strains(found.x))[1],
        "tangent_ms": own,
        "factorisation_ms": timed(lambda: factor.factorise(data.copy()))[1],
        "iterations": run.iterations,
        "converged": run.converged,
        "equilibrium_ms": wall,
        "equilibrium_processor_ms": processor,
        "linear_response_ms": timed(lambda: linear_response(shell, found.x, factor))[1],
        "scikit_fem_ms": theirs,
    }


def _rolled(preview: Preview) -> np.ndarray:
    """The guess that the preview of a tube starts from."""
    kinds, _ = initial_guesses(preview.shell, preview.shell.factor())
    return next(start.x for start in kinds if start.shape.name == "arc")


def scikit_fem_ms(shell: Shell) -> float:
    """Milliseconds of the flat sheet's tangent by scikit-fem's forms, on the same mesh, with the same quadrature.

    On a mesh of size one: its Argyris triangle inverts global monomials, which fails in mm.
    """
    size = float(np.ptp(shell.space.mesh.p))
    mesh = MeshTri(shell.space.mesh.p / size, shell.space.mesh.t)
    basis = Basis(mesh, ElementVector(ElementTriArgyris(), 3), intorder=QUADRATURE_ORDER)
    assert 3 * shell.space.size == basis.N
    stiffness = isotropic(11.5, 0.5, 0.3)

    @BilinearForm
    def tangent(u: Any, v: Any, w: Any) -> Any:
        def strains(f: Any) -> Any:
            first, second = f.grad, f.hess
            return np.array(
                [
                    first[0, 0], first[1, 1], first[0, 1] + first[1, 0],
                    second[2, 0, 0], second[2, 1, 1], 2.0 * second[2, 0, 1],
                ]
            )  # fmt: skip

        return np.einsum("i...,ij,j...->...", strains(u), stiffness, strains(v))

    begin = time.process_time()
    tangent.assemble(basis)
    return 1e3 * (time.process_time() - begin)


def design_row(name: str) -> dict[str, Any]:
    """A whole design: cold, again, edited, and by the exact model."""
    design = gallery.load(name)
    command = [sys.executable, "-c", COLD.format(name=name)]
    cold, cold_processor = [], []
    for _ in range(3):
        begin = time.perf_counter()
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        cold.append(time.perf_counter() - begin)
        cold_processor.append(float(said))
    new_print, again = timed(lambda: preview_of_a_new_print(design)), timed(lambda: Preview(design).shape())
    preview = Preview(design)
    exact, fine = exact_shape(design), exact_shape(on_the_laws_mesh(design))
    linear, solve, whole, processor, minima = [], [], [], [], True
    for size, share in EDITS:
        for edited in (changed(design, size, share), design) * 2:
            begin, used = time.perf_counter(), time.process_time()
            for stage in preview.edit(edited):
                if stage.name == "linear":
                    linear.append(1e3 * (time.perf_counter() - begin))
                    solve.append(1e3 * preview.seconds["linear response"])
            whole.append(1e3 * (time.perf_counter() - begin))
            processor.append(1e3 * (time.process_time() - used))
            minima = minima and preview.equilibrium.is_minimum
    summary = preview.shape().summary
    return {
        "design": name,
        "stars": summary["stars"],
        "triangles": summary["shell_triangles"],
        "is_minimum": minima,
        "cold_s": statistics.median(cold),
        "cold_processor_s": statistics.median(cold_processor),
        "new_print_ms": new_print[0],
        "new_print_processor_ms": new_print[1],
        "again_ms": again[0],
        "again_processor_ms": again[1],
        "equilibrium_ms": 1e3 * Preview(design).seconds["equilibrium"],
        "edit_ms": statistics.median(whole),
        "edit_processor_ms": statistics.median(processor),
        "slowest_edit_ms": max(processor),
        "linear_ms": statistics.median(linear),
        "linear_solve_ms": statistics.median(solve),
        "exact_s": exact.summary["wall_s"],
        "fine_s": fine.summary["wall_s"],
        "fine_vertices": fine.summary["vertices"],
        "wall_s_by_stage": summary["wall_s_by_stage"],
    }


def preview_of_a_new_print(design: Design) -> None:
    """A shape whose print is not among those that are kept."""
    forget_prints()
    Preview(design).shape()


def changed(design: Design, size: str, share: float) -> Design:
    """A size of all stars times `share`; it must be the same for all of them."""
    data = design.to_dict()
    data["stars"][size] *= share
    return Design.from_dict(data)


def on_the_laws_mesh(design: Design) -> Design:
    """The design with the edges that the law's cells have: the exact shape that the preview stands for."""
    data = design.to_dict()
    data["mesh"]["edge_mm"] = paper_law().edge_mm
    return Design.from_dict(data)


def main(words: list[str]) -> None:
    groups, tables, rows = words or ["shell", "designs"], [load()], []
    if "shell" in groups:
        found = [shell_row(count) for count in TRIANGLES]
        tables.append(
            "### One sheet, three meshes\n\nMilliseconds of processor time.\n\n"
            + markdown(SHELL, [shell_line(r) for r in found])
        )
        rows += found
        print(tables[-1], flush=True)
    if "designs" in groups:
        exact_shape(gallery.load("star"))  # compiles
        found = [design_row(name) for name in DESIGNS]
        tables.append("### Whole designs\n\n" + markdown(WHOLE, [design_line(r) for r in found]))
        rows += found
        print(tables[-1], flush=True)
    if not words:
        write_report("preview", rows, "\n\n".join(tables))


def load() -> str:
    """How busy the machine was."""
    if not hasattr(os, "getloadavg"):
        return "The load of the machine is not known."
    return f"Programs that wanted the cores, mean of the last 15 minutes: {os.getloadavg()[2]:.1f}."


def shell_line(r: dict[str, Any]) -> list[str]:
    """One line of the first table."""
    return [
        str(r["triangles"]),
        str(r["unknowns"]),
        f"{r['strains_ms']:.2f}",
        f"{r['tangent_ms']:.1f}",
        f"{r['factorisation_ms']:.1f}",
        f"{r['linear_response_ms']:.2f}",
        f"{r['scikit_fem_ms']:.0f}",
        f"{r['scikit_fem_ms'] / r['tangent_ms']:.0f}",
        str(r["iterations"]) + ("" if r["converged"] else " (not converged)"),
        f"{r['equilibrium_processor_ms']:.0f}",
        f"{r['equilibrium_ms']:.0f}",
    ]


def design_line(r: dict[str, Any]) -> list[str]:
    """One line of the second table."""
    return [
        r["design"] + ("" if r["is_minimum"] else " (no minimum)"),
        str(r["stars"]),
        str(r["triangles"]),
        f"{r['cold_s']:.2f}",
        f"{r['cold_processor_s']:.2f}",
        f"{r['new_print_ms']:.0f}",
        f"{r['new_print_processor_ms']:.0f}",
        f"{r['again_ms']:.0f}",
        f"{r['again_processor_ms']:.0f}",
        f"{r['equilibrium_ms']:.0f}",
        f"{r['edit_ms']:.0f}",
        f"{r['edit_processor_ms']:.0f}",
        f"{r['slowest_edit_ms']:.0f}",
        f"{r['linear_ms']:.1f}",
        f"{r['linear_solve_ms']:.2f}",
        f"{r['exact_s']:.1f}",
        f"{1e3 * r['exact_s'] / r['new_print_ms']:.0f}",
        f"{r['fine_s']:.1f}",
        f"{1e3 * r['fine_s'] / r['new_print_ms']:.0f}",
        f"{1e3 * r['fine_s'] / r['edit_ms']:.0f}",
    ]


if __name__ == "__main__":
    main(sys.argv[1:])
