"""Documents that a page opens: a design file of the folder, a copy of a design of the gallery, or a new sheet."""

from __future__ import annotations

from pathlib import Path

from asterism.pattern import gallery
from asterism.studio import requests as ask
from asterism.studio.autosave import autosave_path
from asterism.studio.document import Document
from asterism.studio.examples import NEW_SHEET, free_name
from asterism.studio.local_files import file_below
from asterism.studio.request import RequestError


def opened(folder: Path, request: ask.Open | ask.New) -> Document:
    """The document that a request opens.

    Raises
    ------
    RequestError, FileNameError, DesignError
        There is no such design, or its file is not one.
    """
    if isinstance(request, ask.New):
        return Document(NEW_SHEET, free_name(folder, "sheet"))
    if request.gallery is not None:
        if request.gallery not in (*gallery.names(), *gallery.pattern_names()):
            raise RequestError(f"{request.gallery!r} is not in the gallery")
        return Document.copy_of(gallery.path(request.gallery), free_name(folder, request.gallery))
    path = design_path(folder, request.name or "")
    return Document.unsaved(path) if not path.exists() and autosave_path(path).exists() else Document.open(path)


def design_path(folder: Path, name: str) -> Path:
    """The path of a design file of the folder; a name without an ending is that of a TOML file."""
    return file_below(folder, name if name.endswith((".toml", ".json")) else f"{name}.toml")
