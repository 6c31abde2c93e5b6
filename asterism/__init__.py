"""asterism: the shape of plastic stars printed on stretched fabric.

import asterism

design = asterism.load_design("design.toml")  # or asterism.new("tube")
preview = asterism.preview(design)  # in a second or two
shape = asterism.simulate(design)
shape.summary["is_minimum"], shape.height_mm
asterism.write_results(shape, "out")
asterism.show(preview)  # in a notebook
asterism.verify(design).summary["rms_percent"]  # how far the two are apart
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

# An installation has the engines (`asterism.fem`, ...) inside this folder; in a checkout they stand beside it.
if not (Path(__file__).parent / "fem").is_dir():
    __path__.append(str(Path(__file__).parents[1]))

from asterism.process.version import __version__

if TYPE_CHECKING:
    from asterism.equilibrium.errors import Error as Error
    from asterism.exact.spread import spread as spread
    from asterism.fitting.fit import Fit as Fit
    from asterism.fitting.fit import fit as fit
    from asterism.fitting.solve_for import sensitivity as sensitivity
    from asterism.fitting.solve_for import solve_for as solve_for
    from asterism.fitting.solve_for import solve_for_point as solve_for_point
    from asterism.fitting.target import TargetSurface as TargetSurface
    from asterism.fitting.target_files import load_target as load_target
    from asterism.homogenize.law.law import Law as Law
    from asterism.homogenize.law.law_file import load_law as load_law
    from asterism.homogenize.law.material import load_material as load_material
    from asterism.laws.law import calibrate as calibrate
    from asterism.laws.law import show_law as show_law
    from asterism.measure.compare import compare as compare
    from asterism.measure.compare import write_comparison as write_comparison
    from asterism.measure.fit_strips import fit_strips as fit_strips
    from asterism.measure.fit_strips import write_material as write_material
    from asterism.measure.new_strips import new_strips as new_strips
    from asterism.notebook.show import show as show
    from asterism.pattern.design.design import Design as Design
    from asterism.pattern.design.design import save_design as save_design
    from asterism.pattern.gallery import load as new
    from asterism.pattern.layout.build import load_design as load_design
    from asterism.previews.session import Preview as Preview
    from asterism.previews.session import preview as preview
    from asterism.print.export import export as export
    from asterism.process.settings import ExportSettings as ExportSettings
    from asterism.process.settings import FitSettings as FitSettings
    from asterism.process.settings import StripFitSettings as StripFitSettings
    from asterism.process.settings import StripPrintSettings as StripPrintSettings
    from asterism.reports.compare_designs import compare_designs as compare_designs
    from asterism.reports.design_report import report as report
    from asterism.reports.fit_page import write_fit as write_fit
    from asterism.reports.verification_page import write_verification as write_verification
    from asterism.reports.write_results import write_results as write_results
    from asterism.shape.shape import Shape as Shape
    from asterism.shape.vtu import read_shape as read_shape
    from asterism.sweeps.sweep import Sweep as Sweep
    from asterism.sweeps.sweep import sweep_design as sweep
    from asterism.sweeps.sweep import write_sweep as write_sweep
    from asterism.verification.simulate import simulate as simulate
    from asterism.verification.verify import Verification as Verification
    from asterism.verification.verify import verify as verify

# Where each public name is defined. It is imported when it is first used: the solvers take most of a second.
_HOMES = {
    "Design": "asterism.pattern.design.design:Design",
    "Error": "asterism.equilibrium.errors:Error",
    "ExportSettings": "asterism.process.settings:ExportSettings",
    "Fit": "asterism.fitting.fit:Fit",
    "FitSettings": "asterism.process.settings:FitSettings",
    "Law": "asterism.homogenize.law.law:Law",
    "Preview": "asterism.previews.session:Preview",
    "Shape": "asterism.shape.shape:Shape",
    "StripFitSettings": "asterism.process.settings:StripFitSettings",
    "StripPrintSettings": "asterism.process.settings:StripPrintSettings",
    "Sweep": "asterism.sweeps.sweep:Sweep",
    "TargetSurface": "asterism.fitting.target:TargetSurface",
    "Verification": "asterism.verification.verify:Verification",
    "calibrate": "asterism.laws.law:calibrate",
    "compare": "asterism.measure.compare:compare",
    "compare_designs": "asterism.reports.compare_designs:compare_designs",
    "export": "asterism.print.export:export",
    "fit": "asterism.fitting.fit:fit",
    "fit_strips": "asterism.measure.fit_strips:fit_strips",
    "load_design": "asterism.pattern.layout.build:load_design",
    "load_law": "asterism.homogenize.law.law_file:load_law",
    "load_material": "asterism.homogenize.law.material:load_material",
    "load_target": "asterism.fitting.target_files:load_target",
    "new": "asterism.pattern.gallery:load",
    "new_strips": "asterism.measure.new_strips:new_strips",
    "preview": "asterism.previews.session:preview",
    "read_shape": "asterism.shape.vtu:read_shape",
    "report": "asterism.reports.design_report:report",
    "save_design": "asterism.pattern.design.design:save_design",
    "sensitivity": "asterism.fitting.solve_for:sensitivity",
    "show": "asterism.notebook.show:show",
    "show_law": "asterism.laws.law:show_law",
    "simulate": "asterism.verification.simulate:simulate",
    "solve_for": "asterism.fitting.solve_for:solve_for",
    "solve_for_point": "asterism.fitting.solve_for:solve_for_point",
    "spread": "asterism.exact.spread:spread",
    "sweep": "asterism.sweeps.sweep:sweep_design",
    "verify": "asterism.verification.verify:verify",
    "write_comparison": "asterism.measure.compare:write_comparison",
    "write_fit": "asterism.reports.fit_page:write_fit",
    "write_material": "asterism.measure.fit_strips:write_material",
    "write_results": "asterism.reports.write_results:write_results",
    "write_sweep": "asterism.sweeps.sweep:write_sweep",
    "write_verification": "asterism.reports.verification_page:write_verification",
}
# type checkers take an import under another name as public only if it is written out here
__all__ = ["__version__", "new", "sweep", *_HOMES]


def __dir__() -> list[str]:
    return sorted(__all__)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    module, _, attribute = _HOMES[name].partition(":")
    return getattr(import_module(module), attribute)
