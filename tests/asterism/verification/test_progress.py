"""The progress of an exact shape in numbers, and a verification of a preview that is there already."""

from __future__ import annotations

import pytest

import asterism
from asterism.equilibrium.newton.minimise import Iteration
from asterism.pattern.design.design import Design
from asterism.verification.progress import WHOLE, ExactProgress
from asterism.verification.run import STAGES, verify

STEP = Iteration(0, 0.0, 0.0, 0.0, 0.0)


def test_release_and_meshes_share_the_steps() -> None:
    told: list[int] = []
    progress = ExactProgress("exact", lambda stage, done, of: told.append(done))
    for text in (
        "300 vertices, 20 %",
        "300 vertices, 100 %",
        "300 vertices, equilibrium",
        "1000 vertices, equilibrium",
    ):
        progress.report(text, STEP)
    progress.report("300 vertices, 40 %, to the side", STEP)
    progress.report("4000 vertices, equilibrium", STEP)
    progress.finish()
    assert told == sorted(told) and told[0] == 0 and told[-1] == WHOLE and max(told[:-1]) < WHOLE
    assert told[1] == 10 and told[2] == 50 and 50 < told[3] < told[4] < told[6]


@pytest.mark.slow
@pytest.mark.parametrize("edge_mm", [6.0])
def test_a_ready_preview_is_not_made_again(edge_mm: float, monkeypatch: pytest.MonkeyPatch) -> None:
    data = asterism.new("dome").to_dict() | {"border": {"rings": 1}, "mesh": {"edge_mm": edge_mm}}
    design = Design.from_dict(data)
    ready = asterism.preview(design)
    monkeypatch.setattr("asterism.verification.run.preview", lambda *_, **__: pytest.fail("made again"))
    told: list[tuple[str, int, int]] = []
    found = verify(design, ready=ready, progress=lambda *step: told.append(step))
    assert found.preview is ready and found.summary["preview_s"] == ready.summary["wall_s"]
    assert list(dict.fromkeys(stage for stage, _, _ in told)) == list(STAGES)
    assert all(told[-1][1:] == (1, 1) for _ in STAGES)
