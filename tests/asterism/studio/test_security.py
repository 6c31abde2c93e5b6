"""Attacks on the studio: strangers, names that lead out, messages that mean nothing; the page's own files."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from asterism.pattern import gallery
from asterism.studio.pages import MAX_TABS
from asterism.studio.requests import MAX_REQUEST_BYTES
from asterism.studio.server import PAGE
from asterism.studio.studio import Studio
from asterism.studio.uploads import MAX_UPLOAD_BYTES
from tests.asterism.studio.conftest import HOST, LIVE, ORIGIN, TOKEN, Page, upload
from tests.asterism.studio.test_uploads import dxf

STRANGER = {"origin": "http://evil.example"}


def test_a_wrong_token_or_none_reaches_nothing(client: TestClient):
    for token in ("", "x", TOKEN[:-1], f"{TOKEN}x", TOKEN.upper(), "page", "%00", "☃"):
        for path in ("", "page/index.html", "gallery/dome.png", "file/dome.toml"):
            answer = client.get(f"/{token}/{path}")
            assert answer.status_code == 404 and answer.text == "not found", (token, path)
    assert client.get("/").status_code == client.get("/favicon.ico").status_code == 404


def test_another_host_is_refused(client: TestClient):
    for host in ("evil.example", "127.0.0.1", "127.0.0.1:7001", f"{HOST}.evil.example", ""):
        headers = {**ORIGIN, "host": host}
        assert client.get(f"/{TOKEN}/", headers=headers).status_code == 403, host
        with pytest.raises(WebSocketDisconnect), client.websocket_connect(LIVE, headers=headers):
            pass


def test_another_page_is_refused(client: TestClient, studio: Studio):
    others = ("http://evil.example", "null", "", f"https://{HOST}", f"http://{HOST}.evil.example", "http://127.0.0.1")
    refused: list[tuple[str, dict[str, str]]] = [(LIVE, {"origin": origin}) for origin in others]
    for path, headers in [*refused, (LIVE, {}), (f"ws://{HOST}/wrong/live", ORIGIN), (f"ws://{HOST}/live", ORIGIN)]:
        with pytest.raises(WebSocketDisconnect), client.websocket_connect(path, headers=headers):
            pass
    assert len(studio.tabs) == 0
    place = f"/{TOKEN}/upload?kind=image"
    assert client.post(place, content=b"x", headers=STRANGER).status_code == 403
    assert client.post(place, content=b"x").status_code == 403
    assert client.get(f"/{TOKEN}/file/dome.toml", headers=STRANGER).status_code == 403
    for kind in ("", "law", "image&kind=exe"):
        assert upload(client, kind, "", b"x").status_code == 404


def test_files_can_only_be_read(client: TestClient, folder: Path):
    before = (folder / "dome.toml").read_bytes()
    for method in ("PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "POST"):
        assert client.request(method, f"/{TOKEN}/file/dome.toml", headers=ORIGIN).status_code == 405, method
    assert (folder / "dome.toml").read_bytes() == before


TRAVERSALS = [
    "../secret.toml",
    "..%2fsecret.toml",
    "%2e%2e%2fsecret.toml",
    "..%5csecret.toml",
    "sub/../../secret.toml",
    "sub%2f..%2f..%2fsecret.toml",
    "//etc/passwd",
    "%2fetc%2fpasswd",
    "C:%5cWindows%5cwin.ini",
    "link.toml",
    "link/secret.toml",
    ".hidden.toml",
    "sub/.hidden.toml",
    "dome.toml%00.png",
    "dome.toml/",
    "a" * 5000,
    "",
    "sub",
]


@pytest.fixture
def outside(folder: Path) -> Path:
    """A file beside the folder of the design, and links to it."""
    secret = folder.parent / "secret.toml"
    secret.write_text("secret = 1\n", encoding="utf-8")
    (folder / "sub").mkdir()
    for hidden in (folder / ".hidden.toml", folder / "sub" / ".hidden.toml"):
        hidden.write_text("secret = 1\n", encoding="utf-8")
    (folder / "link.toml").symlink_to(secret)
    (folder / "link").symlink_to(folder.parent, target_is_directory=True)
    return secret


def test_names_lead_to_files_below_their_folder_only(client: TestClient, outside: Path):
    for room in ("file", "page", "gallery"):
        assert client.get(f"/{TOKEN}/{room}", follow_redirects=True).status_code == 404, room
        for name in TRAVERSALS:  # folders are not listed either
            answer = client.get(f"/{TOKEN}/{room}/{name}", follow_redirects=True)
            assert answer.status_code in (400, 404), (room, name)
            assert "secret" not in answer.text and "root:" not in answer.text, (room, name)


def test_designs_are_opened_and_saved_below_the_folder_only(page: Page, outside: Path):
    page.until("document")
    before = sorted(path for path in outside.parent.rglob("*") if not path.name.startswith(".asterism"))
    links = ("../secret", "/tmp/x", "link", "link/secret", ".x", "a/../../x", "..")
    for name in (*links, "a\nb", "a\0b", "x" * 300, "C:\\x", ""):
        for kind in ("open", "save") if name else ("open",):
            page.send(type=kind, name=name)
            page.until("problem")
    assert outside.read_text(encoding="utf-8") == "secret = 1\n"
    assert sorted(path for path in outside.parent.rglob("*") if not path.name.startswith(".asterism")) == before


def test_pictures_and_drawings_of_a_design_are_read_below_its_folder_only(page: Page, outside: Path):
    Image.new("L", (4, 4), 90).save(outside.with_suffix(".png"))
    page.until("document")
    drawing = {"file": "/etc/passwd.svg"}
    changes: list[dict[str, Any]] = [{"rods.import": [drawing]}, {"border": drawing}, {"border.file": drawing["file"]}]
    for image in ("../secret.png", "/etc/passwd", "link/secret.png", ".hidden.png"):
        profile = {"image": image, "low": 5.0, "high": 9.0}
        changes.append({"stars.override": [{"site": [0, 0]}], "stars.length_mm": profile})
    for each in changes:
        page.send(type="edit", changes=each)
        assert "below the design's folder" in page.until("problem")["text"], each


def test_answers_carry_the_content_policy(client: TestClient):
    for path in ("", "page/", "gallery/", "file/dome.toml", "nothing", "gallery/dome.png"):
        headers = client.get(f"/{TOKEN}/{path}").headers
        policy = headers["content-security-policy"]
        if path.startswith("file/"):  # a report cannot run scripts
            assert "sandbox" in policy and "script" not in policy
        else:
            assert "default-src 'self'" in policy
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["referrer-policy"] == "no-referrer"
        assert "access-control-allow-origin" not in headers


def test_uploads_that_are_too_large_are_refused_before_they_are_read(client: TestClient):
    read = 0

    def parts() -> Any:
        nonlocal read
        for _ in range(100):
            read += 1_000_000
            yield b"\0" * 1_000_000

    answer = client.post(f"/{TOKEN}/upload?kind=image", content=parts(), headers=ORIGIN)
    assert answer.status_code == 413 and "8 MB" in answer.json()["problem"]["text"]
    declared = client.post(f"/{TOKEN}/upload?kind=image", content=b"\0" * (MAX_UPLOAD_BYTES + 1), headers=ORIGIN)
    assert declared.status_code == 413


UNREADABLE = [
    ("image", "../../x.png", b"\x89PNG\r\n\x1a\n" + b"\0" * 100),
    ("outline", "a.svg", b"<svg"),
    ("outline", "a.dxf", dxf(lambda space: space.add_line((0, 0), (10, 0)))),  # open
    ("drawing", "a.dxf", b"AutoCAD Binary DXF\r\n\x1a\x00" + b"\xff" * 100),
    ("drawing", "a.png", b"x"),
    ("target", "a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
    ("outline", "a.svg", b'<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;">]><svg>&b;</svg>'),
    ("outline", "a.svg", b'<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><svg>&a;</svg>'),
]


@pytest.mark.slow
def test_uploads_that_cannot_be_read_are_refused_in_one_line(client: TestClient):
    for kind, name, content in UNREADABLE:
        answer = upload(client, kind, name, content)
        assert answer.status_code == 422, (kind, name, content)
        text = answer.json()["problem"]["text"]
        assert text and not any(word in text for word in ("\n", "root:", "tmp", "upload")), (kind, name, content)


NONSENSE = [
    "",
    "{",
    "null",
    '{"type": "shutdown"}',
    '{"type": "ack", "frame": 1e400}',
    '{"type": "ack", "frame": ' + "9" * 5000 + "}",
    '{"type": "sizes", "sites": [[0, 0]], "length": [1, 2]}',
    '{"type": "sizes", "sites": [[0, 0]], "length": [NaN]}',
    '{"type": "sizes", "sites": [[1e9, 0]], "length": [5]}',
    '{"type": "brush", "size": "width_mm", "mode": "set", "radius": 5, "strength": 1, "low": 0, "high": 9,'
    ' "places": [[]]}',
    '{"type": "edit", "changes": {"fabric.stretch": NaN}}',
    '{"type": "edit", "changes": {"fabric.stretch.deep.deeper": 1}}',
    '{"type": "edit", "changes": {"stars": null}}',
    '{"type": "edit", "changes": {"stars.override": [{"site": [1, 2, 3]}]}}',
    '{"type": "edit", "changes": {"border.polygon_mm": [[0, 0], [1e300, 0], [0, 1e300]]}}',
    '{"type": "edit", "changes": {"stars.length_mm": {"formula": "__import__(\'os\').system(\'true\')"}}}',
    '{"type": "edit", "changes": {"stars.length_mm": {"formula": "9**9**9**9"}}}',
    '{"type": "edit", "changes": {"name": "half a character \\ud800"}}',
    '{"type": "edit", "changes": {"a": ' + "[" * 50_000 + "]" * 50_000 + "}}",
    "[" * 200_000,
    '{"type": "open", "gallery": "../dome"}',
    '{"type": "printer", "name": "/etc/passwd"}',
    '{"type": "export", "printer": "../x", "plastic": "y"}',
    '{"type": "export", "directory": "/tmp"}',
]


def test_messages_without_meaning_get_a_problem_and_change_nothing(page: Page, studio: Studio):
    before = page.until("document")
    for text in (*NONSENSE, b"\0" * 1000):
        page._socket.send_bytes(text) if isinstance(text, bytes) else page.send_text(text)
        problem = page.until("problem")
        assert problem["text"] and "\n" not in problem["text"] and len(problem["text"]) < 2000, text[:40]
        page.send(type="hello")
        assert page.until("document")["design"] == before["design"], text[:40]
        assert studio.jobs.data() == {}, text[:40]


def test_a_message_that_is_too_large_is_refused(page: Page):
    page.until("document")
    page.send_text(json.dumps({"type": "edit", "changes": {"name": "x" * MAX_REQUEST_BYTES}}))
    assert "MB" in page.until("problem")["text"]


def test_an_error_of_the_server_itself_is_survived(page: Page, studio: Studio, monkeypatch: pytest.MonkeyPatch):
    page.until("document")

    def broken(*arguments: Any) -> None:
        raise ZeroDivisionError("a mistake in the server")

    monkeypatch.setattr(studio.document, "undo", broken)
    page.send(type="undo")
    page.until("problem")
    monkeypatch.undo()
    page.send(type="hello")
    page.until("document")


def test_more_pages_than_allowed_are_refused_politely(client: TestClient, studio: Studio):
    assert MAX_TABS == 50
    sockets = [client.websocket_connect(LIVE, headers=ORIGIN) for _ in range(MAX_TABS)]
    for socket in sockets:
        socket.__enter__()
    try:
        with client.websocket_connect(LIVE, headers=ORIGIN) as one_more:
            refusal = one_more.receive_json()
            assert refusal["type"] == "problem" and "50" in refusal["text"]
            with pytest.raises(WebSocketDisconnect):
                one_more.receive_json()
        assert len(studio.tabs) == MAX_TABS
    finally:
        for socket in sockets:
            socket.__exit__(None, None, None)
    with client.websocket_connect(LIVE, headers=ORIGIN) as again:
        Page(again).until("document")


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
