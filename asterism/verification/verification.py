"""The result of a verification: the shapes of both models and their comparison."""

from __future__ import annotations

from dataclasses import dataclass, field

from asterism.pattern.design.design import Design
from asterism.results.records.verification import VerificationRecord
from asterism.shape.comparison import Comparison
from asterism.shape.shape import Shape
from asterism.verification.minima import right_shape

RELEASE = "release"  # name of the exact shape that is released from the flat print
PREVIEW = "preview"  # name of the exact shape that is started from the preview


@dataclass(frozen=True)
class Verification:
    """The preview and the exact shapes of one design, and their distances.

    Attributes
    ----------
    design : the design of all shapes.
    preview : the preview, with the corrugation of its stars.
    exact : exact shapes by their start: `release`, the continuation from the flat print, and `preview`.
    comparisons : the preview laid on each exact shape, by the same names.
    summary : the numbers of summary.json.
    """

    design: Design
    preview: Shape
    exact: dict[str, Shape]
    comparisons: dict[str, Comparison]
    summary: VerificationRecord = field(default_factory=lambda: VerificationRecord.from_json({}))

    @property
    def result(self) -> str:
        """Name of the exact shape that counts, see `asterism.verification.minima`."""
        return right_shape(self.exact)

    @property
    def comparison(self) -> Comparison:
        """The preview laid on the exact shape that counts."""
        return self.comparisons[self.result]
