"""What can go wrong with a law or a campaign; every message is one line."""

from __future__ import annotations

from collections.abc import Iterable

from equilibrium.errors import Error


class LawError(Error, ValueError):
    """A law that cannot be read, or does not go with a design.

    Parameters
    ----------
    message : one line.
    stars : numbers of the stars that the error is about.
    place_mm : printed place (2,) that the error is about; None if it has none.
    """

    def __init__(self, message: str, stars: Iterable[int] = (), place_mm: Iterable[float] | None = None) -> None:
        super().__init__(message)
        self.stars = tuple(int(star) for star in stars)
        self.place_mm = None if place_mm is None else tuple(float(part) for part in place_mm)


class ForeignLaw(LawError):
    """A law that was made for another material, lattice or stretch; one of the design's own would do."""


class AddressError(Error, ValueError):
    """No cluster answers."""


class CampaignError(Error):
    """A campaign that has no law: too many cells without an answer, or workers that have ended."""

    exit_status = 1
