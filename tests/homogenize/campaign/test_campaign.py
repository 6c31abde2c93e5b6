"""Campaigns: resumed where they stopped, the same whatever runs them, failures told and not fatal."""

from __future__ import annotations

import copy
import logging
import multiprocessing
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from asterism.homogenize.campaign import workers
from asterism.homogenize.campaign.campaign import run_campaign
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.campaign.kept_samples import SAMPLE_SOURCES
from asterism.homogenize.campaign.workers import CampaignProgress
from asterism.homogenize.errors import AddressError, CampaignError
from asterism.homogenize.law.law_file import law_bytes, law_digest
from asterism.homogenize.law.material import Material
from asterism.homogenize.law.plan import LawPlan, SampleRecord
from tests.event_loop import run_coroutine
from tests.homogenize import fake, same_process
from tests.test_rooms import package_of

SMALL = {"lengths_mm": [5.0, 10.0], "thicknesses_mm": [0.2, 0.4], "widths_mm": [1.0, 1.4], "held_out": 2}


def plan(**changes: Any) -> LawPlan:
    return Material.from_dict({"name": "test", "plan": {**SMALL, **changes}}).law_plan()


@pytest.fixture(scope="module")
def once(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[SampleRecord]]:
    """A folder of samples, and their records."""
    folder = tmp_path_factory.mktemp("campaign") / "samples"
    with pytest.MonkeyPatch.context() as monkeypatch:
        same_process.use(monkeypatch)
        return folder, run_campaign(plan(), folder, 1, respond=fake.solve_cell)


@pytest.fixture
def one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """For tests of what a campaign does with its answers, whichever process finds them."""
    same_process.use(monkeypatch)


@pytest.fixture
def samples(once: tuple[Path, list[SampleRecord]], tmp_path: Path) -> Path:
    """A copy of the folder to go on from, or to spoil."""
    return Path(shutil.copytree(once[0], tmp_path / "samples"))


@pytest.fixture
def records(once: tuple[Path, list[SampleRecord]]) -> list[SampleRecord]:
    """A copy of the records."""
    return copy.deepcopy(once[1])


@pytest.mark.slow
def test_the_law_does_not_depend_on_the_number_of_workers(tmp_path: Path) -> None:
    laws = [fit_law(plan(), run_campaign(plan(), tmp_path / str(n), jobs=n, respond=fake.matrix)) for n in (1, 3)]
    assert law_bytes(laws[0]) == law_bytes(laws[1]) and law_digest(laws[0]) == law_digest(laws[1])
    # and once more from the files alone
    told: list[CampaignProgress] = []
    again = fit_law(plan(), run_campaign(plan(), tmp_path / "3", report=told.append, respond=fake.matrix))
    assert law_bytes(again) == law_bytes(laws[0]) and [p.done for p in told] == [p.total for p in told]


@pytest.mark.usefixtures("one_process")
def test_progress_counts_and_estimates(tmp_path: Path) -> None:
    told: list[CampaignProgress] = []
    records = run_campaign(plan(), tmp_path, 2, report=told.append, respond=fake.fails_when_thin)
    assert [p.done for p in told] == list(range(len(records) + 1)) and told[0].total == len(records) == 11
    assert told[0].seconds_left is None and told[-1].seconds_left == 0.0 and told[3].seconds_left > 0
    assert told[-1].failed == 2
    reasons = {record.failed for record in records if record.failed}
    assert reasons == {"tube: still curling at 0.13/mm, the tightest tried"}


@pytest.mark.usefixtures("one_process")
def test_files_are_reused_only_for_the_same_inputs(samples: Path, records: list[SampleRecord]) -> None:
    assert len(fake.files(samples)) == len(records)
    # more cells: only the new ones are solved
    told: list[CampaignProgress] = []
    run_campaign(plan(lengths_mm=[5.0, 7.0, 10.0]), samples, 1, report=told.append, respond=fake.solve_cell)
    assert told[0].done == len(records)
    # another material, mesh or version of the format shares nothing
    other = Material.from_dict({"plan": SMALL, "plastic": {"modulus_ratio": 3000.0}}).law_plan()
    keys = {fake.sample_name(m, t) for m in (plan(), other, plan(edge_mm=2.1)) for t in m.tasks()}
    assert len(keys) == 3 * len(records)


@pytest.mark.usefixtures("one_process")
def test_samples_belong_to_what_solved_them(samples: Path) -> None:
    told: list[CampaignProgress] = []
    other = run_campaign(plan(), samples, 1, report=told.append, respond=fake.curls_more)
    assert told[0].done == 0
    again = run_campaign(plan(), samples, 1, report=told.append, respond=fake.curls_more)
    assert told[-1].done == told[-1].total and [r.sample for r in again] == [r.sample for r in other]
    task = plan().tasks()[0]
    assert fake.sample_name(plan(), task) != fake.sample_name(plan(), task, fake.solve_cell)


@pytest.mark.slow
def test_samples_belong_to_the_code_that_made_them(samples: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("asterism.homogenize.campaign.campaign.code_version", lambda: "other code")
    told: list[CampaignProgress] = []
    records = run_campaign(plan(), samples, 1, report=told.append, respond=fake.solve_cell)
    assert told[0].done == 0
    # workers that have not changed with it are found out
    assert {record.failed for record in records} == {"RuntimeError: the worker has another version of asterism"}


@pytest.mark.usefixtures("one_process")
def test_a_damaged_file_is_solved_again(samples: Path, records: list[SampleRecord]) -> None:
    files = sorted(samples.iterdir())
    files[0].write_text('{"inputs": ')
    files[1].write_text('{"inputs": {}, "sample": null}')
    told: list[CampaignProgress] = []
    assert [r.sample for r in run_campaign(plan(), samples, 1, report=told.append, respond=fake.solve_cell)] == [
        r.sample for r in records
    ]
    assert told[0].done == len(records) - 2


def test_bare_fabric_without_an_answer_says_why(records: list[SampleRecord]) -> None:
    wrong = [
        replace(r, sample={**r.sample, "bending": [-1.0, -1.0, -1.0]}) if r.sample and r.task.is_bare else r
        for r in records
    ]
    with pytest.raises(CampaignError, match=r"the bare fabric at stretch .* has no answer: bending = -1 is no answer"):
        fit_law(plan(), wrong)


@pytest.mark.usefixtures("one_process")
def test_an_exception_is_a_failed_cell_and_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    records = run_campaign(plan(), tmp_path, 2, respond=fake.breaks)
    assert {r.failed for r in records if r.task.sizes[0] == 10.0} == {"AssertionError: a bug"}
    assert all(r.failed is None for r in records if r.task.sizes[0] != 10.0)
    monkeypatch.setenv("ASTERISM_FAKE_MENDED", "")
    assert all(r.failed is None for r in run_campaign(plan(), tmp_path, 2, respond=fake.breaks))


@pytest.mark.slow
@pytest.mark.usefixtures("one_process")
def test_arms_that_overlap_are_a_failed_cell_and_not_tried_again(tmp_path: Path) -> None:
    square = {"kind": "square", "spacing_mm": 17.0, "arms": 4}
    cells = {"lengths_mm": [12.0], "thicknesses_mm": [0.3], "widths_mm": [1.2], "edge_mm": 4.0, "held_out": 0}
    crossed = Material.from_dict({"lattice": square, "plan": cells}).law_plan()
    for _ in range(2):
        told: list[CampaignProgress] = []
        records = run_campaign(crossed, tmp_path, report=told.append)
        assert records[0].failed is None and "overlap; shorten or turn them" in str(records[1].failed)
    assert told[0].done == 2


@pytest.mark.slow
def test_a_worker_that_dies_ends_the_campaign_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(CampaignError, match="worker process has ended"):
        run_campaign(plan(), tmp_path, 2, respond=fake.dies)
    same_process.use(monkeypatch)
    monkeypatch.setenv("ASTERISM_FAKE_MENDED", "")
    assert all(r.failed is None for r in run_campaign(plan(), tmp_path, 2, respond=fake.dies))


@pytest.mark.usefixtures("one_process")
def test_no_law_from_too_few_answers_and_none_without_a_worker(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="at least 1"):
        run_campaign(plan(), tmp_path, 0, respond=fake.fails)
    records = run_campaign(plan(), tmp_path, 1, respond=fake.fails)
    with pytest.raises(CampaignError, match=r"bare fabric .* no equilibrium at all"):
        fit_law(plan(), records)


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_interrupted_campaigns_leave_whole_files_and_no_workers(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    psutil = pytest.importorskip("psutil")
    script = tmp_path / "campaign.py"
    script.write_text(
        "import sys\nfrom pathlib import Path\nfrom tests.homogenize import fake\n"
        "from tests.homogenize.campaign.test_campaign import plan, run_campaign\n"
        "run_campaign(plan(), Path(sys.argv[1]), 2, respond=fake.slow)\n"  # and no main guard
    )
    samples = tmp_path / "samples"
    process = subprocess.Popen([sys.executable, str(script), str(samples)], stderr=subprocess.DEVNULL)
    while not (samples.exists() and len(list(samples.glob("*.json"))) >= 2):
        time.sleep(0.02)
        assert process.poll() is None
    children = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(number)
    process.wait(timeout=20)
    assert not psutil.wait_procs(children, timeout=10)[1]
    same_process.use(monkeypatch)
    told: list[CampaignProgress] = []
    records = run_campaign(plan(), samples, 2, report=told.append, respond=fake.slow)
    assert 2 <= told[0].done < len(records) and all(record.failed is None for record in records)


@pytest.mark.slow
def test_dask_gives_the_same_law(tmp_path: Path, records: list[SampleRecord]) -> None:
    distributed = pytest.importorskip("distributed")
    own = fit_law(plan(), records)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        records = run_campaign(plan(), tmp_path / "dask", dask=cluster.scheduler_address, respond=fake.solve_cell)
        assert law_bytes(fit_law(plan(), records)) == law_bytes(own)
        # a second run has nothing left to ask the cluster for
        run_campaign(plan(), tmp_path / "dask", dask="tcp://127.0.0.1:1", respond=fake.solve_cell)

        async def notebook() -> list[SampleRecord]:
            return run_campaign(plan(), tmp_path / "notebook", dask=cluster.scheduler_address, respond=fake.solve_cell)

        assert law_bytes(fit_law(plan(), run_coroutine(notebook()))) == law_bytes(own)


@pytest.mark.slow
def test_a_cluster_whose_workers_have_gone_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its scheduler would keep the cells for workers to come."""
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(workers, "MAX_WAIT_FOR_WORKERS_S", 1.0)
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:

        def leave(progress: CampaignProgress) -> None:
            if progress.done == 1:
                cluster.scale(0)

        with pytest.raises(CampaignError, match="the workers are gone; finished samples are kept"):
            run_campaign(plan(), tmp_path, dask=cluster.scheduler_address, respond=fake.slow, report=leave)
    assert len(list(tmp_path.iterdir())) >= 1


# a cluster in a process of its own, which prints its address
CLUSTER = """
import time, distributed
if __name__ == "__main__":
    cluster = distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None)
    print(cluster.scheduler_address, flush=True)
    time.sleep(100)
"""


@pytest.mark.slow
def test_a_scheduler_that_is_killed_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    printed: list[logging.LogRecord] = []
    monkeypatch.setattr(logging.getLogger("distributed.client"), "handle", printed.append)
    cluster = subprocess.Popen([sys.executable, "-c", CLUSTER], stdout=subprocess.PIPE, text=True)

    def kill(progress: CampaignProgress) -> None:
        if progress.done == 1:
            cluster.kill()

    try:
        assert cluster.stdout is not None
        address = cluster.stdout.readline().strip()
        with pytest.raises(CampaignError, match="the scheduler is gone; finished samples are kept"):
            run_campaign(plan(), tmp_path, dask=address, respond=fake.slow, report=kill)
        assert printed == []
    finally:
        cluster.kill()
        cluster.communicate()


def in_a_daemon(folder: Path) -> None:
    run_campaign(plan(), folder, 2, respond=fake.solve_cell)


@pytest.mark.slow
def test_a_process_of_the_studio_has_workers_too(tmp_path: Path) -> None:
    """It is a daemon, which may have no children of multiprocessing."""
    process = multiprocessing.get_context("spawn").Process(target=in_a_daemon, args=(tmp_path,), daemon=True)
    process.start()
    process.join()
    assert process.exitcode == 0 and len(list(tmp_path.iterdir())) == len(plan().tasks())


@pytest.mark.usefixtures("one_process")
def test_a_folder_that_another_run_took_away_is_made_again(tmp_path: Path) -> None:
    """A run that ends before its first cell leaves no empty folder, but others may be about to write there."""
    folder = tmp_path / "law.samples"

    def gone(progress: CampaignProgress) -> None:
        if progress.done == 0:
            folder.rmdir()

    records = run_campaign(plan(), folder, 1, report=gone, respond=fake.solve_cell)
    assert all(record.failed is None for record in records)
    assert len(list(folder.iterdir())) == len(records)


@pytest.mark.parametrize("notebook", [False, True])
def test_a_cluster_that_is_not_there(notebook: bool, tmp_path: Path) -> None:
    """Also where a loop is running already."""
    pytest.importorskip("distributed")

    def ask() -> None:
        run_campaign(plan(), tmp_path, dask="nonsense://x", respond=fake.solve_cell)

    async def ask_from_a_notebook() -> None:
        ask()

    with pytest.raises(AddressError, match=r"^--dask: no scheduler answers at 'nonsense://x'"):
        run_coroutine(ask_from_a_notebook()) if notebook else ask()


# of pattern: what solves a cell imports these too, and takes no number from them
ASIDE = (
    # designs and their files: what they say is among the inputs that a sample is named by
    *("design.design", "design.errors", "design.files", "design.section", "design.stars"),
    *("design.material_files", "design.spread"),
    # sizes that vary, outlines, pins and drawings: a cell has none
    *("design.border", "design.pins", "design.rods", "design.drawings"),
    *("drawing.dxf", "drawing.read", "drawing.records", "drawing.rhino", "drawing.svg"),
    *("design.sizing.expression", "design.sizing.grey_image", "design.sizing.profiles"),
)


@pytest.mark.slow
def test_the_name_of_the_code_stands_for_every_module_that_decides_answers() -> None:
    script = (
        "import sys, asterism.homogenize.cell.sample, asterism.homogenize.cell.motif_responses;"
        "print(*(name for name, module in sys.modules.items() if not hasattr(module, '__path__')))"
    )
    loaded = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    needed = {name for name in loaded if package_of(name) in {"discrete", "equilibrium", "homogenize", "pattern"}}
    listed = {
        ".".join([package.__name__, *file.relative_to(package.__path__[0]).with_suffix("").parts]).removesuffix(
            ".__init__"
        )
        for package, names in SAMPLE_SOURCES.items()
        for pattern in names
        for file in Path(package.__path__[0]).glob(pattern)
    }
    aside = {f"asterism.pattern.{name}" for name in ASIDE}
    assert needed - aside <= listed
    assert aside <= needed and not aside & listed
