"""What the law of a design covers, for the page."""

from __future__ import annotations

from typing import Any

from asterism.homogenize.errors import ForeignLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import BlankSheetError
from asterism.previews.default_law import law_of
from asterism.previews.serving_law import serving_law
from asterism.studio.messages import Limits


class EngineLimits:
    """Limits, where they differ from the last ones that were asked for."""

    def __init__(self) -> None:
        self._key: Any = None

    def changed(self, design: Design, seq: int) -> Limits | None:
        """The limits of a design; None if its material and lattice are those of the last one.

        Raises
        ------
        DesignError, LawError
            The file of the law cannot be read, or there is no law of such a design.
        """
        key = (design.fabric, design.lattice, design.plastic, design.material)
        if key == self._key:
            return None
        if design.stars is None:
            self._key = key
            return Limits(seq, {}, ())  # cells of motifs are solved where the sizes are
        ranges, statement = {}, None
        self._key = None
        try:
            law = serving_law(design)
            ranges, statement = law.size_ranges(design.fabric.stretch_xy[0]), law.statement
            self._key = key
        except (ForeignLaw, BlankSheetError):
            pass  # the preview says so, and a law may serve other stars
        return Limits(seq, ranges, law_of(design).stretches, statement)
