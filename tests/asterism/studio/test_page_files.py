"""Files of the page: all of them are in the wheel, and none names another machine."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from asterism.pattern import gallery
from asterism.studio.server import PAGE

ROOT = Path(__file__).parents[3]
STUDIO = ROOT / "asterism" / "studio"
FILES = sorted(file for room in ("page", "gallery") for file in (STUDIO / room).rglob("*") if file.is_file())
MAX_GALLERY_BYTES = 1_000_000


def test_all_files_are_package_data():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = project["tool"]["setuptools"]["package-data"]["asterism.studio"]
    covered = {file for pattern in patterns for file in STUDIO.glob(pattern)}
    assert [file.name for file in FILES if file not in covered] == []
    assert (PAGE / "index.html").is_file()


def test_every_design_of_the_gallery_has_a_small_picture():
    pictures = {file.stem: file.stat().st_size for file in (STUDIO / "gallery").glob("*.png")}
    assert set(pictures) == {*gallery.names(), *gallery.pattern_names()}
    assert sum(pictures.values()) < MAX_GALLERY_BYTES


def test_the_page_names_no_other_machine():
    for file in FILES:
        if file.suffix != ".png":
            text = file.read_text(encoding="utf-8").replace("http://www.w3.org/", "")
            assert re.findall(r"\b(?:https?|wss?)://[\w.]+|@import|//[\w-]+\.\w+/", text) == [], file.name


def test_the_page_fits_its_content_policy():
    html = (PAGE / "index.html").read_text(encoding="utf-8")
    assert not re.search(r"<script(?![^>]*\bsrc=)|<style|\sstyle=|\son\w+=", html)
