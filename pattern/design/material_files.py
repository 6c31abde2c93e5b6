"""The list of measured materials, and the section `[material]` of a design, which names one of them or a file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationError

from asterism.pattern.design.errors import DesignError, from_validation
from asterism.pattern.design.files import own_folders, read_table
from asterism.pattern.design.materials import Fabric, Plastic
from asterism.pattern.design.section import Line, Section, Text
from asterism.pattern.design.spread import Spread

# folder of the materials within a folder of own files
MATERIALS_FOLDER = "materials"
_PACKAGE_FOLDER = Path(__file__).parents[1] / "measured"
_SECTIONS: dict[str, type[Section]] = {"fabric": Fabric, "plastic": Plastic, "spread": Spread}


class MeasurementNote(Section):
    """The section `[measured]` of a material file."""

    source: Line = Field(max_length=300)  # where the values come from: a table of strips, a data sheet, a publication
    date: Line | None = Field(None, max_length=30)  # when they were measured, as year-month-day


class MaterialChoice(Section):
    """The section `[material]` of a design.

    Relative paths begin at the folder of the design file.
    """

    # name in the list of materials, or path of a material file; its values of `[fabric]`, `[plastic]` and `[spread]`
    # become those of the design, which then has no such key itself.
    file: Text | None = Field(None, min_length=1, max_length=1000)
    # path of the law of this material, for previews. The design of a file has it as an absolute path.
    law: Text | None = Field(None, min_length=1, max_length=1000)


def material_files() -> dict[str, Path]:
    """Files of all measured materials by name: those of the user, then those of the package.

    >>> "paper" in material_files()
    True
    """
    files: dict[str, Path] = {}
    for folder in [*(own / MATERIALS_FOLDER for own in own_folders()), _PACKAGE_FOLDER]:
        for file in sorted(folder.glob("*.toml")):
            files.setdefault(file.stem, file)
    return dict(sorted(files.items()))


def material_path(name_or_file: str | Path, field: str, folder: Path = Path()) -> Path:
    """The file of a material.

    Raises `DesignError` if no material has this name.

    Parameters
    ----------
    name_or_file : name in the list of materials, or path of a `.toml` or `.json` file.
    field : field or option of the error.
    folder : where a relative path begins.
    """
    if Path(name_or_file).suffix.lower() in (".toml", ".json"):
        return folder / name_or_file
    files = material_files()
    if str(name_or_file) not in files:
        raise DesignError(field, f"must be a file (.toml) or a name: {', '.join(files)}", str(name_or_file))
    return files[str(name_or_file)]


def own_material_path(name: str, field: str) -> Path:
    """The file of a new material of the user.

    Raises `DesignError` if the name is not letters, digits, `-` and `_`, or the package has a material of this name.
    """
    if not re.fullmatch(r"[\w-]{1,60}", name):
        raise DesignError(field, "must be a name of letters, digits, - and _", name)
    if (_PACKAGE_FOLDER / f"{name}.toml").exists():
        raise DesignError(field, "is the name of a material of the package", name)
    return own_folders()[0] / MATERIALS_FOLDER / f"{name}.toml"


def with_material_file(data: Mapping[str, Any], folder: Path) -> Mapping[str, Any]:
    """The table of a design with the values of the material file that its section `[material]` names.

    The stretch of the file is that of the measurement: it is taken only if the design gives none. Raises `DesignError`
    if the file is missing or wrong, it has no value for the design, or the design has one of its values too.
    """
    if not isinstance(data.get("material"), Mapping):
        return data
    try:
        choice = MaterialChoice.model_validate(data["material"])
    except ValidationError as error:
        raise from_validation(error, table="material") from None
    table = {name: value for name, value in data.items() if name != "material"}
    if choice.law is not None:
        table["material"] = {"law": str((folder / choice.law).absolute())}
    if choice.file is None:
        return table
    taken = dict(_values(material_path(choice.file, "material.file", folder), choice.file))
    for (section, key), value in taken.items():
        own = table.get(section, {})
        if not isinstance(own, Mapping):
            continue  # the design's own error names it
        if key not in own:
            table[section] = {**own, key: value}
        elif (section, key) != ("fabric", "stretch"):
            raise DesignError(
                f"{section}.{key}", f"is given by material.file = {choice.file!r} too: remove one", own[key]
            )
    return table


def _values(path: Path, name: str) -> Iterator[tuple[tuple[str, str], Any]]:
    """The keys and values of `[fabric]`, `[plastic]` and `[spread]` in a material file."""
    table = read_table(path)
    found = False
    for section, kind in _SECTIONS.items():
        values = table.get(section, {})
        try:
            kind.model_validate(values)
        except ValidationError as error:
            raise from_validation(error, path, section) from None
        for key, value in values.items():
            found = True
            yield (section, key), value
    if not found:
        raise DesignError("material.file", "must have values in [fabric], [plastic] or [spread]", name)
