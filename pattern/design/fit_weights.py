"""The section `[fit]`: where a fit to a target surface comes nearer. It has no influence on the shape of the sheet."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import Number, Section
from asterism.pattern.design.stars import Site

# least and largest weight of a place; places without one have the weight 1
WEIGHT_RANGE = (0.01, 100.0)
MAX_WEIGHTED_SITES = 20_000


class WeightedSite(Section):
    """The weight of the places around one star.

    Attributes
    ----------
    site : lattice site, as in `Override`. A site off the sheet is ignored.
    weight : the square of the distance to the target counts so many times.
    """

    site: Site
    weight: Number = Field(ge=WEIGHT_RANGE[0], le=WEIGHT_RANGE[1])


class FitWeights(Section):
    """Weights of places in a fit.

    Attributes
    ----------
    weights : each for the cell of one lattice site; elsewhere the weight is 1.
    """

    weights: tuple[WeightedSite, ...] = Field((), max_length=MAX_WEIGHTED_SITES)

    @model_validator(mode="after")
    def _one_weight_a_site(self) -> Self:
        sites = [entry.site for entry in self.weights]
        if len(set(sites)) < len(sites):
            twice = next(site for number, site in enumerate(sites) if site in sites[:number])
            raise DesignError("weights", "must have one entry a site", list(twice))
        return self
