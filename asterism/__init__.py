"""asterism: the shape of plastic stars printed on stretched fabric.

import asterism

design = asterism.load_design("design.toml")  # or asterism.new("tube")
shape = asterism.simulate(design)
shape.summary["is_minimum"], shape.height_mm
asterism.write_results(shape, "out")
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from asterism.results import write_results
    from asterism.shape import Shape
    from asterism.simulation import simulate
    from pattern.design import Design, load_design, save_design
    from pattern.gallery import load as new

# the solver's imports take most of a second: only who asks for it waits
_HOMES = {
    "Design": ("pattern.design", "Design"),
    "Shape": ("asterism.shape", "Shape"),
    "load_design": ("pattern.design", "load_design"),
    "new": ("pattern.gallery", "load"),
    "save_design": ("pattern.design", "save_design"),
    "simulate": ("asterism.simulation", "simulate"),
    "write_results": ("asterism.results", "write_results"),
}
__all__ = ["Design", "Shape", "__version__", "load_design", "new", "save_design", "simulate", "write_results"]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _HOMES[name]
    return getattr(import_module(module), attribute)
