"""Sizing fields of the design file: a number, or a table with one of the registered profiles."""

from __future__ import annotations

from functools import reduce
from operator import or_
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Discriminator, GetCoreSchemaHandler, Tag
from pydantic_core import CoreSchema

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import Number
from asterism.pattern.design.sizing.profile import Profile
from asterism.pattern.design.sizing.profiles import PROFILES


def _branch(value: Any) -> str:
    """Which member of the union a value of the file belongs to."""
    if isinstance(value, Profile):
        return f"kind:{value.key}"
    if isinstance(value, str):
        return "kind:unknown"
    if not isinstance(value, dict):
        return "kind:number"
    # a table marked by its own key is that, whatever else is in it
    ordered = sorted(PROFILES.values(), key=lambda profile: not profile.is_marked_by_key)
    return f"kind:{next((profile.key for profile in ordered if profile.describes(value)), 'unknown')}"


def _refuse(value: Any) -> None:
    """Say what a sizing field may be."""
    if isinstance(value, dict) and "profile" in value:
        named = [key for key, profile in PROFILES.items() if not profile.is_marked_by_key]
        raise DesignError("profile", f"must be {', '.join(named)}", value["profile"])
    hint = ""
    if isinstance(value, str):
        hint = "; numbers have no quotes" if _is_number(value) else '; a formula is written { formula = "..." }'
    raise DesignError("", f"must be a number, or a table with a profile, a formula or an image{hint}", value)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


class _RegisteredProfiles:
    """Validates a number or a table by the registered profiles."""

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        members: list[Any] = [Annotated[Number, Tag("kind:number")]]
        members += [Annotated[profile, Tag(f"kind:{key}")] for key, profile in PROFILES.items()]
        members.append(Annotated[Any, BeforeValidator(_refuse), Tag("kind:unknown")])
        return handler.generate_schema(Annotated[reduce(or_, members), Discriminator(_branch)])


SizingField = Annotated[float | Profile, _RegisteredProfiles]


def sample(field: float | Profile, points: Floats) -> Floats:
    """(n,) values of a sizing field at the printed points (n, 2) mm.

    Examples
    --------
    >>> sample(7.5, np.zeros((2, 2))).tolist()
    [7.5, 7.5]
    """
    return field.at(points) if isinstance(field, Profile) else np.full(len(points), field)
