"""What can go wrong with a law or a campaign; every message is one line."""

from __future__ import annotations


class LawError(ValueError):
    """A law that cannot be read, or does not go with a design."""


class AddressError(ValueError):
    """No cluster answers."""


class CampaignError(Exception):
    """A campaign that has no law: too many cells without an answer, or workers that have ended."""
