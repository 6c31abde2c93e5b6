"""A server of the components, without a network."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from asterism.hops.components import Work
from asterism.hops.server import application

HOST = "127.0.0.1:5017"


@pytest.fixture(scope="session")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[TestClient, Work]]:
    work = Work(tmp_path_factory.mktemp("served"))
    with TestClient(application(work, frozenset({HOST})), base_url=f"http://{HOST}") as client:
        yield client, work


@pytest.fixture
def client(served: tuple[TestClient, Work]) -> TestClient:
    return served[0]


@pytest.fixture
def folder(served: tuple[TestClient, Work]) -> Path:
    return served[1].folder
