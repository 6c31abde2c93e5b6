"""Errors of laws and campaigns. Every message is one line."""

from __future__ import annotations

from collections.abc import Iterable

from asterism.equilibrium.errors import Error


class LawError(Error, ValueError):
    """A law cannot be read, or does not fit a design.

    Parameters
    ----------
    message : one line.
    stars : numbers of the stars in error.
    place_mm : printed coordinates (2,) of the error, in mm; None if the error has no place.
    field : of the design file that the law does not fit, such as `fabric.stretch`; empty for others.
    """

    def __init__(
        self, message: str, stars: Iterable[int] = (), place_mm: Iterable[float] | None = None, field: str = ""
    ) -> None:
        super().__init__(message)
        self.field = field
        self.stars = tuple(int(star) for star in stars)
        self.place_mm = None if place_mm is None else tuple(float(part) for part in place_mm)


class ForeignLaw(LawError):
    """A law is for another material, lattice or stretch. A law of the design's own stars would fit."""


class UnreadableLaw(LawError):
    """The file of a law is missing, or cannot be read on this machine."""


class AddressError(Error, ValueError):
    """No cluster answers at the address."""


class CampaignError(Error):
    """A campaign gives no law: too many cells have no answer, or the workers have ended."""

    exit_status = 1
