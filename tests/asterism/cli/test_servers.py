"""`asterism studio` and `asterism hops` as they are started and stopped: mistakes in one line, Ctrl-C, unsaved work."""

from __future__ import annotations

import json
import re
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from asterism.pattern import gallery
from asterism.studio.requests import MAX_REQUEST_BYTES
from tests.asterism.commands import Cli

PATIENCE_S = 60


@pytest.fixture
def folder(here: Path) -> Path:
    (here / "dome.toml").write_bytes(gallery.path("dome").read_bytes())
    return here


def test_a_port_in_use_is_one_line(folder: Path, cli: Cli):
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        refusal = cli(["studio", "dome.toml", "--no-browser", "--port", str(port)]).refusal
    assert str(port) in refusal and "in use" in refusal


@contextmanager
def started(*words: str) -> Iterator[subprocess.Popen[str]]:
    """A running server."""
    command = [sys.executable, "-m", "asterism", *words]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def ended(process: subprocess.Popen[str], number: int) -> str:
    """What a server prints at its end, by a signal; a slow start gives a sign of life."""
    process.send_signal(number)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0 and not [line for line in err.splitlines() if "still computing" not in line]
    return out


def page_of(url: str) -> ClientConnection:
    origin = "/".join(url.split("/")[:3])
    return connect(url.replace("http", "ws", 1) + "live", origin=origin, max_size=None, compression=None)  # type: ignore[arg-type]


def until(page: ClientConnection, kind: str) -> dict:
    while True:
        message = page.recv(timeout=PATIENCE_S)
        if isinstance(message, str) and json.loads(message)["type"] == kind:
            return json.loads(message)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["SIGINT", "SIGHUP"])
def test_it_serves_its_page_and_keeps_unsaved_work_at_its_end(name: str, folder: Path):
    if not hasattr(signal, name):
        pytest.skip("there is no such signal")
    with started("studio", "dome.toml", "--no-browser") as process:
        line = process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:\d+/[\w-]{20,}/", line)
        assert found, line
        url = found[0]
        with urllib.request.urlopen(url, timeout=PATIENCE_S) as answer:
            assert "default-src 'self'" in answer.headers["content-security-policy"] and b"<html" in answer.read()
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(url[:-3] + "/", timeout=PATIENCE_S)
        with page_of(url) as page:
            page.send('{"type": "hello"}')
            until(page, "document")
            page.send('{"type": "sizes", "gesture": 1, "sites": [[0, 0]], "length": [7.5]}')
            until(page, "document")
            # larger than any message may be: the connection ends, the studio does not
            with pytest.raises(ConnectionClosed):
                page.send(json.dumps({"type": "edit", "changes": {"name": "x" * (MAX_REQUEST_BYTES + 1)}}))
                while True:
                    page.recv(timeout=PATIENCE_S)
        with page_of(url) as page:
            page.send('{"type": "hello"}')
            until(page, "document")
            out = ended(process, getattr(signal, name))
    assert ".dome.autosave.toml" in out
    assert "7.5" in (folder / ".dome.autosave.toml").read_text(encoding="utf-8")
    assert (folder / "dome.toml").read_bytes() == gallery.path("dome").read_bytes()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="sends the signal of Ctrl-C")
@pytest.mark.usefixtures("here")
def test_hops_serves_and_ends_at_ctrl_c():
    with started("hops", "--port", "0") as process:
        lines = [process.stdout.readline() for _ in range(7)]
        found = re.match(r"http://127\.0\.0\.1:\d+/sites", lines[0])
        assert found and lines[-1] == "Ctrl-C ends it\n"
        with urllib.request.urlopen(found[0], timeout=PATIENCE_S) as answer:
            assert json.load(answer)["Name"] == "sites"
        ended(process, signal.SIGINT)
