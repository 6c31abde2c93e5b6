"""The predictor of the release: iterations, factorisations and processor time of exact shapes with and without it.

python -m benchmarks.predictor [chord]

With the word `chord` it compares Newton's method with chord steps, which keep a factor while the gradient falls.

Each design of the paper's gallery is released from the flat print on its own mesh, with and without the predictor one
after the other. Seconds are processor time, which other programs on the machine disturb little.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from weakref import WeakKeyDictionary, WeakSet

import numpy as np

from asterism.exact.simulation import exact_shape
from benchmarks.report import markdown, write_report
from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State
from discrete.release import continuation
from equilibrium.arrays import Floats
from equilibrium.newton.problem import AnyState
from equilibrium.newton.regularisation import Regularisation
from pattern import gallery

DESIGNS = (
    "dome", "tube", "bell", "cone", "roof", "tunnel", "u-shape", "doubly-curved", "fig5-no-rest-curvature",
    "fig8-h-decreasing", "fig8-h-increasing", "fig8-l-decreasing", "fig8-l-increasing", "fig8-l-uniform",
    "fig9-linear", "fig9-parabola", "arch", "canopy", "saddle", "star",
)  # fmt: skip
HEADER = ["design", "iterations", "with", "factorisations", "with", "processor s", "with", "change of energy"]
Prediction = Callable[[DiscreteModel, tuple[float, State], tuple[float, State]], State]


def last_state(model: DiscreteModel, before: tuple[float, State], last: tuple[float, State]) -> State:
    """No prediction: the step begins at the state of the last one."""
    return model.apply_supports(last[1])


@contextmanager
def without_predictor() -> Iterator[None]:
    """Within the block, each step of the release begins at the state of the last one."""
    predictor: Prediction = continuation.predict_release
    continuation.predict_release = last_state
    try:
        yield
    finally:
        continuation.predict_release = predictor


@contextmanager
def chord_steps(least_decrease: float = 5.0) -> Iterator[None]:
    """Within the block, a definite Hessian's factor serves until the gradient falls by less than this factor."""
    newton_direction = Regularisation.direction
    norms: WeakKeyDictionary[Regularisation, float] = WeakKeyDictionary()
    definite: WeakSet[Regularisation] = WeakSet()

    def direction(self: Regularisation, state: AnyState, gradient: Floats) -> Floats:
        norm = float(np.linalg.norm(gradient))
        falls = norm * least_decrease < norms.get(self, 0.0)
        norms[self] = norm
        if falls and self in definite and self.amount == 0.0:
            return -self._solve(gradient)
        found = newton_direction(self, state, gradient)
        (definite.add if self.amount == 0.0 else definite.discard)(self)
        return found

    Regularisation.direction = direction  # type: ignore[method-assign]
    try:
        yield
    finally:
        Regularisation.direction = newton_direction  # type: ignore[method-assign]


def compare_chord_steps() -> None:
    """Print iterations, factorisations and processor seconds with Newton's method and with chord steps."""
    for name in ("dome", "tube", "roof"):
        newton = measure(name)
        with chord_steps():
            chord = measure(name)
        for label, each in (("Newton", newton), ("chord", chord)):
            print(
                f"{name}, {label}: {each['iterations']}/{each['factorisations']}, {each['seconds']:.2f} s", flush=True
            )


def measure(name: str) -> dict[str, Any]:
    """Iterations, factorisations, processor time (s) and energy (N mm) of a design."""
    begun = time.process_time()
    summary = exact_shape(gallery.load(name)).summary
    return {
        "iterations": summary["iterations"],
        "factorisations": summary["factorisations"],
        "seconds": time.process_time() - begun,
        "energy_n_mm": summary["energy_n_mm"],
        "is_minimum": summary["is_minimum"],
    }


def main() -> None:
    """Print and write the table."""
    measure("star")  # loads the compiled loops
    if sys.argv[1:] == ["chord"]:
        compare_chord_steps()
        return
    rows, lines, ratios = [], [], []
    for name in DESIGNS:
        with without_predictor():
            plain = measure(name)
        predicted = measure(name)
        rows.append({"design": name, "without": plain, "with": predicted})
        change = predicted["energy_n_mm"] / plain["energy_n_mm"] - 1.0
        keys = ("iterations", "factorisations", "seconds")
        numbers = [
            f"{each[key]:.2f}" if key == "seconds" else str(each[key]) for key in keys for each in (plain, predicted)
        ]
        lines.append([name, *numbers, f"{change:.0e}"])
        ratios.append([predicted[key] / plain[key] for key in keys])
        print("  ".join(lines[-1]), flush=True)
    mean = np.exp(np.log(ratios).mean(axis=0))
    text = "With over without, geometric mean: iterations {:.2f}, factorisations {:.2f}, processor time {:.2f}.".format(
        *mean
    )
    write_report("predictor", rows, f"{markdown(HEADER, lines)}\n\n{text}")
    print(text)


if __name__ == "__main__":
    main()
