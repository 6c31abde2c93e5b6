"""Warnings that carry the stars they are about, so that a program can mark them."""

from __future__ import annotations

from collections.abc import Iterable


class PlacedWarning(str):
    """The text of a warning, with the stars that it is about.

    Attributes
    ----------
    stars : numbers of the stars.

    Examples
    --------
    >>> warning = PlacedWarning("2 stars curl too tightly", stars=[3, 7])
    >>> warning, warning.stars
    ('2 stars curl too tightly', (3, 7))
    """

    stars: tuple[int, ...]

    def __new__(cls, text: str, stars: Iterable[int] = ()) -> PlacedWarning:
        warning = super().__new__(cls, text)
        warning.stars = tuple(int(star) for star in stars)
        return warning
