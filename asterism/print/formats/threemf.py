"""3MF: named solids in millimetres at their places, without transforms, which several slicers misread.

This module needs the standard library only: the core of the format is a zipped XML of vertices and triangles.
Reference: 3MF Core Specification 1.3.
"""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as xml

import numpy as np

from asterism.print.formats.registry import export_format
from asterism.print.solid import Solid

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_RELATIONS = "http://schemas.openxmlformats.org/package/2006/relationships"
_TYPES = "http://schemas.openxmlformats.org/package/2006/content-types"
_MODEL = "3D/3dmodel.model"
# a fixed date: equal solids give equal files
_FILE_DATE = (1980, 1, 1, 0, 0, 0)


@export_format("3MF", ".3mf", "print")
def write_3mf(path: Path, solids: Sequence[Solid], title: str) -> None:
    """Write solids as objects of one print; coordinates to a tenth of a micrometre."""
    files = {
        "[Content_Types].xml": _content_types(),
        "_rels/.rels": _relations(),
        _MODEL: _model(solids, title),
    }
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as package:
        for name, root in files.items():
            content = xml.tostring(root, encoding="UTF-8", xml_declaration=True)
            package.writestr(zipfile.ZipInfo(name, _FILE_DATE), content, zipfile.ZIP_DEFLATED)


def _model(solids: Sequence[Solid], title: str) -> xml.Element:
    model = xml.Element("model", {"xmlns": _CORE, "unit": "millimeter", "xml:lang": "en-US"})
    for name, value in (("Title", title), ("Application", "asterism")):
        xml.SubElement(model, "metadata", name=name).text = value
    resources, build = xml.SubElement(model, "resources"), xml.SubElement(model, "build")
    for number, solid in enumerate(solids, 1):
        thing = xml.SubElement(resources, "object", id=str(number), type="model", name=solid.name)
        mesh = xml.SubElement(thing, "mesh")
        vertices, triangles = xml.SubElement(mesh, "vertices"), xml.SubElement(mesh, "triangles")
        for x, y, z in np.round(solid.points, 4).tolist():
            xml.SubElement(vertices, "vertex", x=f"{x:.4f}", y=f"{y:.4f}", z=f"{z:.4f}")
        for a, b, c in solid.triangles.tolist():
            xml.SubElement(triangles, "triangle", v1=str(a), v2=str(b), v3=str(c))
        xml.SubElement(build, "item", objectid=str(number))
    return model


def _content_types() -> xml.Element:
    types = xml.Element("Types", xmlns=_TYPES)
    for extension, kind in (
        ("rels", "application/vnd.openxmlformats-package.relationships+xml"),
        ("model", "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"),
    ):
        xml.SubElement(types, "Default", Extension=extension, ContentType=kind)
    return types


def _relations() -> xml.Element:
    relations = xml.Element("Relationships", xmlns=_RELATIONS)
    kind = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    xml.SubElement(relations, "Relationship", Target=f"/{_MODEL}", Id="rel0", Type=kind)
    return relations
