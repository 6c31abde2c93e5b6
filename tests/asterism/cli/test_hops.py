"""`asterism hops` as it is started and stopped."""

from __future__ import annotations

import json
import re
import signal
import socket
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

from tests.asterism.commands import Cli

PATIENCE_S = 60


@pytest.mark.usefixtures("here")
def test_mistakes_are_one_line(cli: Cli):
    for words, named in (
        (["--folder", "nothing"], "nothing"),
        (["--port", "70000"], "--port"),
        (["--patience", "0"], "--patience"),
    ):
        refused = cli(["hops", *words])
        assert refused.status == 2 and named in refused.line
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        refused = cli(["hops", "--port", str(port)])
    assert refused.status == 2 and str(port) in refused.line and "in use" in refused.line


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="sends the signal of Ctrl-C")
def test_it_serves_and_ends_at_ctrl_c(tmp_path: Path):
    words = [sys.executable, "-m", "asterism", "hops", "--port", "0"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path)
    try:
        assert process.stdout is not None
        lines = [process.stdout.readline() for _ in range(7)]
        found = re.match(r"http://127\.0\.0\.1:\d+/sites", lines[0])
        assert found and lines[-1] == "Ctrl-C ends it\n"
        with urllib.request.urlopen(found[0], timeout=PATIENCE_S) as answer:
            assert json.load(answer)["Name"] == "sites"
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0
        assert not [line for line in err.splitlines() if "still computing" not in line]
    finally:
        process.kill()
        process.communicate()
