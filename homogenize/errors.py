"""What can go wrong with a law or a campaign; every message is one line."""

from __future__ import annotations

from equilibrium.errors import Error


class LawError(Error, ValueError):
    """A law that cannot be read, or does not go with a design."""


class ForeignLaw(LawError):
    """A law that was made for another material, lattice or stretch; one of the design's own would do."""


class AddressError(Error, ValueError):
    """No cluster answers."""


class CampaignError(Error):
    """A campaign that has no law: too many cells without an answer, or workers that have ended."""

    exit_status = 1
