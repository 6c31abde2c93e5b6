"""Results appear complete or not at all, whatever happens while they are written."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from asterism.pattern.design.files import write_table
from asterism.results.files import OutputError, check_writable, staged, staged_result, write_file

NAMES = ["rods.vtu", "shape.obj", "shape.png", "shape.vtu", "summary.json"]


def write(directory: Path, content: str) -> None:
    with staged(directory) as folder:
        for name in NAMES:
            (folder / name).write_text(content)


def contents(directory: Path) -> dict[str, str]:
    """Every file below a directory, hidden ones too."""
    return {str(f.relative_to(directory)): f.read_text() for f in directory.rglob("*") if f.is_file()}


def whole(content: str) -> dict[str, str]:
    return dict.fromkeys(NAMES, content)


def test_new_directories_have_ordinary_permissions(tmp_path: Path) -> None:
    write(tmp_path / "a" / "results", "new")
    assert contents(tmp_path / "a" / "results") == whole("new")
    (tmp_path / "ordinary").mkdir()
    assert (tmp_path / "a" / "results").stat().st_mode == (tmp_path / "ordinary").stat().st_mode


@pytest.mark.parametrize("error", [KeyboardInterrupt(), ValueError("no")])
def test_an_exception_while_writing_leaves_nothing(tmp_path: Path, error: BaseException) -> None:
    write(tmp_path / "old", "old")
    for target in (tmp_path / "old", tmp_path / "new" / "deep"):
        with pytest.raises(type(error)), staged(target) as folder:
            (folder / "shape.vtu").write_text("half")
            raise error
    assert contents(tmp_path / "old") == whole("old")
    assert [p.name for p in tmp_path.iterdir()] == ["old"]


@pytest.mark.skipif(sys.platform == "win32", reason="no limits on file sizes")
def test_a_real_failing_write(tmp_path: Path) -> None:
    """A process that may not write large files, as on a disk that fills up."""
    write(tmp_path / "old", "old")
    program = (
        "import resource; from asterism.results.files import staged, OutputError\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))\n"
        "try:\n"
        "    with staged('old') as folder: (folder / 'shape.vtu').write_bytes(bytes(100_000))\n"
        "except OutputError as error: print(error)\n"
    )
    run = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True)
    assert run.stdout.strip() == "cannot write old: the file would be larger than allowed", run.stderr
    assert contents(tmp_path) == {f"old/{name}": "old" for name in NAMES}


def test_things_in_the_way_and_names_that_are_too_long_are_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    for target in (tmp_path / "file", tmp_path / "file" / "deep" / "er"):
        with pytest.raises(OutputError, match=r"^cannot write .*file.*: a file is in the way$"):
            check_writable(target)
    (tmp_path / "link").symlink_to("nowhere")
    with pytest.raises(OutputError, match=r"link: a file is in the way$"):
        check_writable(tmp_path / "link")
    (tmp_path / "results" / "shape.vtu").mkdir(parents=True)
    with pytest.raises(OutputError, match=r"shape\.vtu: a folder is in the way$"):
        write(tmp_path / "results", "new")
    with pytest.raises(OutputError, match=r"results: a folder is in the way$"):
        check_writable(tmp_path, "results")
    assert contents(tmp_path) == {"file": "mine"}
    name = 300 * "x"
    for too_long in ((tmp_path / name,), (tmp_path / "new", name)):
        with pytest.raises(OutputError, match=rf"^cannot write .*{name}: the name is too long$"):
            check_writable(*too_long)
    check_writable(tmp_path / "a" / "b")
    assert not (tmp_path / "a").exists() and not (tmp_path / "new").exists()


@pytest.mark.parametrize("name", ["shape.png", "minimum-2.vtu"])
def test_files_of_somebody_else_with_names_of_results_are_not_written_over(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text("mine")
    with pytest.raises(OutputError, match=f"{name} was not written by asterism; choose another"):
        check_writable(tmp_path)
    check_writable(tmp_path, "design.toml")
    (tmp_path / "summary.json").write_text('{"version": "1"}')
    check_writable(tmp_path)


def test_a_summary_of_somebody_else_is_not_written_over(tmp_path: Path) -> None:
    for mine in ("my notes", '{"sales": 3}', "[1, 2]", 5000 * "["):
        (tmp_path / "summary.json").write_text(mine)
        with pytest.raises(OutputError, match=r"summary\.json was not written by asterism; choose another folder"):
            check_writable(tmp_path)
        check_writable(tmp_path, "export.json")
    for ours in ('{"version": "0.1.0"}', '{"digest": "a"}'):
        (tmp_path / "summary.json").write_text(ours)
        check_writable(tmp_path)
    # a result may go beside an export
    (tmp_path / "summary.json").unlink()
    for name in ("export.json", "shape.vtu", "rods.vtu", "shape.obj"):
        (tmp_path / name).write_text("{}")
    check_writable(tmp_path)


def killed_at(directory: Path, moment: str) -> None:
    """A process writes new files, and is killed at the third call of a function of `os`."""
    program = (
        "import os, signal\n"
        "from asterism.results.files import staged_result\n"
        f"calls, act = [], os.{moment}\n"
        "def deadly(*words):\n"
        "    calls.append(words)\n"
        "    if len(calls) == 3: os.kill(os.getpid(), signal.SIGKILL)\n"
        "    return act(*words)\n"
        f"os.{moment} = deadly\n"
        f"with staged_result({str(directory)!r}) as folder:\n"
        f"    for name in {NAMES!r}: (folder / name).write_text('new')\n"
    )
    assert subprocess.run([sys.executable, "-c", program]).returncode == -signal.SIGKILL


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such kill")
def test_a_kill_leaves_no_old_summary_beside_new_files(tmp_path: Path) -> None:
    write(tmp_path, '{"version": 1}')
    (tmp_path / "minimum-2.vtu").write_text("old")
    killed_at(tmp_path, "fsync")
    assert not any(text == "new" for name, text in contents(tmp_path).items() if not name.startswith("."))
    killed_at(tmp_path, "replace")
    assert "new" in contents(tmp_path).values() and not (tmp_path / "summary.json").exists()
    check_writable(tmp_path)  # it is still a folder of results
    with staged_result(tmp_path) as folder:
        (folder / "summary.json").write_text("{}")
    assert contents(tmp_path) == {"summary.json": "{}"}


def test_files_have_the_permissions_that_the_user_gives_new_files(tmp_path: Path) -> None:
    before = os.umask(0o077)
    try:
        write_table({"name": "a"}, tmp_path / "a.toml")
        write_file(tmp_path / "b.toml", "name = 1")
    finally:
        os.umask(before)
    assert {file.stat().st_mode & 0o777 for file in tmp_path.iterdir()} == {0o600}


KINDS = {
    "simulate": {"summary.json", "shape.vtu", "rods.vtu", "shape.obj", "shape.png", "minimum-2.vtu", "minimum-2.png"},
    "verify": {"summary.json", "report.html", "exact.vtu", "preview.vtu", "exact.obj", "preview.obj"},
    "compare": {"summary.json", "compare.png"},
    "law show": {"summary.json", "law.png"},
}
MINE = {"notes.txt", "my shape.vtu", "shape.vtu.bak", "shape.stl", "export.json", "minimum-2.txt"}


def fill(folder: Path, names: set[str], content: str = "old") -> None:
    for name in names:
        (folder / name).write_text(content)


@pytest.mark.parametrize("after", KINDS)
def test_one_kind_is_left(after: str, tmp_path: Path) -> None:
    fill(tmp_path, set().union(*KINDS.values()) | MINE)
    with staged_result(tmp_path) as folder:
        fill(folder, KINDS[after], "new")
    assert contents(tmp_path) == dict.fromkeys(KINDS[after], "new") | dict.fromkeys(MINE, "old")


def test_a_full_disk_leaves_the_other_kind_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fill(tmp_path, KINDS["verify"])
    move = os.replace

    def full(source: Path, target: Path) -> None:
        if target == tmp_path / "compare.png":
            raise OSError(errno.ENOSPC, "No space left on device")
        move(source, target)

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OutputError, match="the disk is full"), staged_result(tmp_path) as folder:
        fill(folder, KINDS["compare"], "new")
    assert contents(tmp_path) == dict.fromkeys(KINDS["verify"], "old")


def test_a_folder_that_holds_no_result_keeps_its_files(tmp_path: Path) -> None:
    """A report of something else, in the folder where results are now written."""
    fill(tmp_path, {"report.html", "cells.csv"})
    with staged_result(tmp_path) as folder:
        fill(folder, KINDS["compare"], "new")
    assert contents(tmp_path) == dict.fromkeys(KINDS["compare"], "new") | {"report.html": "old", "cells.csv": "old"}
