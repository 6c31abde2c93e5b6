"""3MF: named solids in millimetres at their places, without transforms, which several slicers misread.

No library writes it: the core of the format is a zipped XML of vertices and triangles.
Reference: 3MF Core Specification 1.3.
"""

from __future__ import annotations

import math
import zipfile
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as xml

import numpy as np

from asterism.pattern.design.rounding import Rounding
from asterism.print.formats.registry import export_format
from asterism.print.solid import Solid

_MODEL = "3D/3dmodel.model"
# more walls than half the lines of the widest arm
WALLS = 20


@export_format("3MF", ".3mf", "print")
def write_3mf(path: Path, solids: Sequence[Solid], title: str, rounding: Rounding | None = None) -> None:
    """Write solids as objects of one print; coordinates to a tenth of a micrometre.

    With the layers and lines of a `rounding`, each object carries settings for PrusaSlicer.
    """
    files = {"[Content_Types].xml": _content_types(), "_rels/.rels": _relations(), _MODEL: _model(solids, title)}
    if rounding is not None:  # settings of single objects, as PrusaSlicer reads them; other programs pass over them
        files["Metadata/Slic3r_PE_model.config"] = _settings(solids, rounding)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as package:
        for name, root in files.items():
            content = xml.tostring(root, encoding="UTF-8", xml_declaration=True)
            # a fixed date: equal solids give equal files
            package.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), content, zipfile.ZIP_DEFLATED)


def _model(solids: Sequence[Solid], title: str) -> xml.Element:
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    model = xml.Element("model", {"xmlns": core, "unit": "millimeter", "xml:lang": "en-US"})
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


def _settings(solids: Sequence[Solid], rounding: Rounding) -> xml.Element:
    config = xml.Element("config")
    for number, solid in enumerate(solids, 1):
        thing = xml.SubElement(config, "object", id=str(number))
        for key, value in ({"name": solid.name} | prusa_settings(rounding)).items():
            xml.SubElement(thing, "metadata", type="object", key=key, value=value)
        xml.SubElement(thing, "volume", firstid="0", lastid=str(len(solid.triangles) - 1))
    return config


def _content_types() -> xml.Element:
    types = xml.Element("Types", xmlns="http://schemas.openxmlformats.org/package/2006/content-types")
    for extension, kind in (
        ("rels", "application/vnd.openxmlformats-package.relationships+xml"),
        ("model", "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"),
        ("config", "text/xml"),
    ):
        xml.SubElement(types, "Default", Extension=extension, ContentType=kind)
    return types


def _relations() -> xml.Element:
    relations = xml.Element("Relationships", xmlns="http://schemas.openxmlformats.org/package/2006/relationships")
    kind = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    xml.SubElement(relations, "Relationship", Target=f"/{_MODEL}", Id="rel0", Type=kind)
    return relations


def wider_mm(rounding: Rounding) -> float:
    """By how much each side of a solid is moved outwards for slicers whose lines have round edges.

    In PrusaSlicer and its forks a line of width w and height h holds h (w - (1 - pi/4) h), less than a rectangle:
    11 % in a line of 0.4 x 0.2 mm. Arms that are wider by (1 - pi/4) h get the plastic of the solid.
    """
    height = (rounding.first_layer_mm + rounding.layer_mm) / 2
    return round((1 - math.pi / 4) * height / 2, 3)


def prusa_settings(rounding: Rounding) -> dict[str, str]:
    """Settings of one object in PrusaSlicer, which go before those of its profiles."""
    widths = ("", "perimeter_", "external_perimeter_", "infill_", "solid_infill_", "top_infill_")
    return {
        "layer_height": f"{rounding.layer_mm:g}",
        "perimeter_generator": "arachne",
        "perimeters": str(WALLS),
        **{f"{part}extrusion_width": f"{rounding.line_mm:g}" for part in widths},
        "xy_size_compensation": f"{wider_mm(rounding):g}",
        # each of these takes lines away from the first or the last layer
        "elefant_foot_compensation": "0",
        "only_one_perimeter_first_layer": "0",
        "top_one_perimeter_type": "none",
        "fill_density": "100%",
        "fill_pattern": "rectilinear",
        "brim_type": "no_brim",
        "raft_layers": "0",
        "support_material": "0",
    }
