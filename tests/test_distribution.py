"""The distribution: a wheel from the source archive installs, and runs outside the checkout with all its data."""

from __future__ import annotations

import json
import os
import shutil
import site
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ENGINES = ("discrete", "equilibrium", "fem", "homogenize", "pattern")


@pytest.mark.slow
def test_archive_and_wheel_install_and_run_elsewhere(tmp_path: Path) -> None:
    copy = tmp_path / "checkout"
    kept_out = shutil.ignore_patterns(".git", ".venv", "build", "dist", "*.egg-info", "__pycache__", ".*_cache")
    shutil.copytree(ROOT, copy, ignore=kept_out)
    # an archive first, and the wheel from the archive: what the archive lacks, the wheel lacks too
    build = [sys.executable, "-m", "build", "--outdir", str(tmp_path / "dist"), str(copy)]
    subprocess.run(build, check=True, capture_output=True)
    archive, wheel = sorted((tmp_path / "dist").iterdir(), key=lambda file: file.suffix)
    assert archive.name.startswith("asterism_fabric-") and wheel.name.startswith("asterism_fabric-")

    place = tmp_path / "venv"
    venv.create(place, with_pip=True)
    scripts = place / ("Scripts" if os.name == "nt" else "bin")
    packages = Path(sysconfig.get_path("purelib", vars={"base": str(place), "platbase": str(place)}))
    # the packages that asterism needs are those of this environment; asterism itself is not
    needed = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib"), *site.getsitepackages()}
    (packages / "needed.pth").write_text("\n".join(sorted(needed)) + "\n", encoding="utf-8")
    pip = [str(scripts / "python"), "-m", "pip", "install", "--quiet", "--no-deps", "--force-reinstall", str(wheel)]
    subprocess.run(pip, check=True, capture_output=True)

    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}

    def run(*words: str) -> str:
        command = [str(scripts / "python"), "-I", *words]
        done = subprocess.run(command, cwd=elsewhere, env=environment, capture_output=True, text=True, check=True)
        return done.stdout

    # one name, so that nothing of another project is overwritten
    assert {file.name.split("-")[0] for file in packages.iterdir()} >= {"asterism", "asterism_fabric"}
    assert not [engine for engine in ENGINES if (packages / engine).exists()]
    for module in ("asterism", *(f"asterism.{engine}" for engine in ENGINES)):
        where = run("-c", f"import {module}; print({module}.__file__)")
        assert Path(where.strip()).is_relative_to(packages / "asterism")
    assert (packages / "asterism" / "py.typed").exists()
    for room in ("page", "gallery"):
        files = {
            root / "asterism" / "studio" / room: sorted(
                file.relative_to(root).as_posix()
                for file in (root / "asterism/studio" / room).rglob("*")
                if file.is_file()
            )
            for root in (ROOT, packages)
        }
        assert len({tuple(names) for names in files.values()}) == 1, room
    run("-m", "asterism", "new", "star", "-o", "star.toml")
    run("-m", "asterism", "preview", "star.toml", "-o", "out")
    assert json.loads((elsewhere / "out" / "summary.json").read_text(encoding="utf-8"))["is_minimum"]
    assert "ultimaker2" in run("-m", "asterism", "printers")
    assert "paper" in run("-m", "asterism", "materials")
    run("-m", "asterism", "new", "canopy", "-o", "canopy.toml")
    # without MKL: the solver's package is hidden, and scipy's takes over
    hide = "import sys; sys.modules['pypardiso'] = None; from asterism.cli.main import main; "
    hide += "sys.argv[1:] = ['simulate', 'star.toml', '-o', 'superlu', '--backend', 'superlu']; main()"
    run("-c", hide)
    assert json.loads((elsewhere / "superlu" / "summary.json").read_text(encoding="utf-8"))["backend"] == "superlu"
