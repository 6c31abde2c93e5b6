"""asterism: the shape of plastic stars printed on stretched fabric.

import asterism

design = asterism.load_design("design.toml")  # or asterism.new("tube")
preview = asterism.preview(design)  # in a second or two
shape = asterism.simulate(design)
shape.summary["is_minimum"], shape.height_mm
asterism.write_results(shape, "out")
asterism.verify(design).summary["rms_percent"]  # how far the two are apart
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from asterism.exact.simulation import simulate
    from asterism.previews.run import preview
    from asterism.previews.session import Preview
    from asterism.reports.verification_files import write_verification
    from asterism.reports.write_results import write_results
    from asterism.shape.shape import Shape
    from asterism.verification.run import verify
    from asterism.verification.verification import Verification
    from homogenize.law.file import load_law
    from pattern.design.design import Design, save_design
    from pattern.gallery import load as new
    from pattern.layout.load_design import load_design

# the solver's imports take most of a second: only who asks for it waits
_HOMES = {
    "Design": ("pattern.design.design", "Design"),
    "Preview": ("asterism.previews.session", "Preview"),
    "Shape": ("asterism.shape.shape", "Shape"),
    "Verification": ("asterism.verification.verification", "Verification"),
    "load_design": ("pattern.layout.load_design", "load_design"),
    "load_law": ("homogenize.law.file", "load_law"),
    "new": ("pattern.gallery", "load"),
    "preview": ("asterism.previews.run", "preview"),
    "save_design": ("pattern.design.design", "save_design"),
    "simulate": ("asterism.exact.simulation", "simulate"),
    "verify": ("asterism.verification.run", "verify"),
    "write_results": ("asterism.reports.write_results", "write_results"),
    "write_verification": ("asterism.reports.verification_files", "write_verification"),
}
__all__ = [
    "Design",
    "Preview",
    "Shape",
    "Verification",
    "__version__",
    "load_design",
    "load_law",
    "new",
    "preview",
    "save_design",
    "simulate",
    "verify",
    "write_results",
    "write_verification",
]


def __dir__() -> list[str]:
    return sorted(__all__)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _HOMES[name]
    return getattr(import_module(module), attribute)
