"""What can go wrong with a law or a campaign; every message is one line."""

from __future__ import annotations


class LawError(ValueError):
    """A law that cannot be read, or does not go with a design."""


class ForeignLaw(LawError):
    """A law that was made for another material, lattice or stretch; one of the design's own would do."""


class AddressError(ValueError):
    """No cluster answers."""


class CampaignError(Exception):
    """A campaign that has no law: too many cells without an answer, or workers that have ended."""
