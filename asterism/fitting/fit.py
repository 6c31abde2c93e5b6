"""The result of a fit: a design for a target surface, with the evidence of how near its shape comes."""

from __future__ import annotations

from dataclasses import dataclass

from asterism.fitting.first_guess import FirstGuess
from asterism.fitting.residual import FitDistance
from asterism.fitting.target import TargetSurface
from asterism.pattern.design.design import Design
from asterism.results.records.fit import FitRecord
from asterism.shape.shape import Shape
from asterism.verification.verification import Verification


@dataclass(frozen=True, eq=False)
class Fit:
    """A design for a target, with the evidence of how near its shape comes.

    Attributes
    ----------
    design : as it is written and was verified.
    target : in the pose of the fit.
    guess : the first guess, with the map to the print and what stars can do.
    preview : fresh preview of the design.
    verification : preview and exact shapes; None if the exact model was not asked for, or the fit was interrupted.
    distance : of the exact shape to the target, or of the preview without one.
    summary : the numbers of summary.json.
    """

    design: Design
    target: TargetSurface
    guess: FirstGuess
    preview: Shape
    verification: Verification | None
    distance: FitDistance
    summary: FitRecord

    @property
    def shape(self) -> Shape:
        """The exact shape, or the preview without one; a free sheet is laid on the target."""
        return self.distance.shape


class FitInterrupted(KeyboardInterrupt):
    """Ctrl-C has ended a fit.

    Attributes
    ----------
    fitted : the best design until then, by the preview.
    """

    def __init__(self, fitted: Fit) -> None:
        super().__init__("the fit was interrupted")
        self.fitted = fitted
