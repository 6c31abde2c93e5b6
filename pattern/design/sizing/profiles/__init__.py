"""All sizing profiles, one a file. A new file in this folder registers its profile."""

from __future__ import annotations

import importlib
import pkgutil

from asterism.pattern.design.sizing.profile import Profile


def _registered() -> dict[str, type[Profile]]:
    """The profiles in the files of this folder, by their keys in alphabetical order."""
    profiles = {}
    for module_info in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{module_info.name}")
        for member in vars(module).values():
            if isinstance(member, type) and issubclass(member, Profile) and member.__module__ == module.__name__:
                profiles[member.key] = member
    return dict(sorted(profiles.items()))


PROFILES = _registered()
