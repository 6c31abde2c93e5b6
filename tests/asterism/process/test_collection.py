"""Reference cycles are not collected while a command loads libraries, and are while it computes and after it."""

from __future__ import annotations

import gc
import io
import weakref

import pytest

from asterism.cli.common.run import Run
from asterism.process.collection import late_collection, no_collection


class Cycle:
    """An object that only the collector can free."""

    def __init__(self) -> None:
        self.itself = self


@pytest.mark.parametrize("begins", ["computing", "hand_over"])
def test_cycles_are_collected_from_the_computation_on(begins: str) -> None:
    run = Run()
    run.stream = io.StringIO()
    with late_collection():
        assert not gc.isenabled()
        if begins == "computing":
            with run.computing():
                assert gc.isenabled()
        else:
            run.hand_over()
        assert gc.isenabled()
        cycle = weakref.ref(Cycle())
        gc.collect()
        assert cycle() is None
    assert gc.isenabled()


def test_afterwards_nothing_is_left_out_of_the_collection() -> None:
    """A Python program that runs several commands frees what each of them leaves."""
    with late_collection():
        cycle = weakref.ref(Cycle())
        Run().hand_over()
        gc.collect()
        assert cycle() is not None
    assert gc.get_freeze_count() == 0
    gc.collect()
    assert cycle() is None


@pytest.mark.parametrize("enabled", [True, False])
def test_libraries_load_without_collection_and_the_setting_stays(enabled: bool) -> None:
    states = []
    if not enabled:
        gc.disable()
    try:
        with pytest.raises(ImportError), no_collection():
            states.append(gc.isenabled())
            raise ImportError
        states.append(gc.isenabled())
    finally:
        gc.enable()
    assert states == [False, enabled]
