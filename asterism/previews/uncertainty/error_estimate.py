"""Estimated error of a preview as a value."""

from __future__ import annotations

from dataclasses import dataclass

from asterism.previews.model import PreviewModel
from asterism.previews.uncertainty.distance_error import distance_error_percent, distance_parts
from asterism.previews.uncertainty.error_sources import ErrorSources
from asterism.previews.uncertainty.height_error import height_error_percent
from asterism.previews.uncertainty.other_forms import OtherForm, close_form


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated error of a preview, and its sources.

    Attributes
    ----------
    distance_percent : rms distance to the exact shape in % of the diameter, fitted so that nine of ten exact shapes are
        nearer; None if no estimate is available.
    height_percent : error of the height in % of it; None if no estimate is available.
    sources : from which both are computed.
    main_part : the largest contribution to the distance, a key of `distance_parts`.
    close_form : another form that the sheet may rest in as well.
    energy_uncertainty : of the law, as a share of the energy.
    """

    distance_percent: float | None
    height_percent: float | None
    sources: ErrorSources
    main_part: str
    close_form: OtherForm | None
    energy_uncertainty: float

    @classmethod
    def of(cls, sources: ErrorSources, model: PreviewModel, is_known: bool) -> ErrorEstimate:
        """The estimate from its sources.

        Parameters
        ----------
        is_known : whether an estimate is available for sheets of this kind.
        """
        parts, doubt = distance_parts(sources, model), model.energy_uncertainty
        return cls(
            distance_error_percent(sources, model) if is_known else None,
            height_error_percent(sources, model) if is_known else None,
            sources,
            max(parts, key=lambda name: parts[name]),
            close_form(sources.other_forms, doubt),
            doubt,
        )
