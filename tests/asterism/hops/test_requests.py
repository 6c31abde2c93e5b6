"""What reaches the server: recorded requests, malformed ones, strangers, many at once."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import Any

import httpx2
import pytest
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from asterism.hops.components import Work
from asterism.hops.server import MAX_REQUEST_BYTES, application
from tests.asterism.hops.client import Hops, hexagon
from tests.asterism.hops.conftest import HOST
from tests.event_loop import run_coroutine

RECORDED = sorted((Path(__file__).parent / "requests").glob("*.json"))
JSON = {"content-type": "application/json; charset=utf-8"}
SHEET = json.loads((Path(__file__).parent / "requests" / "sheet.json").read_text(encoding="utf-8"))


@pytest.mark.slow
@pytest.mark.parametrize("path", RECORDED, ids=lambda path: path.stem)
def test_recorded_requests_are_answered(client: TestClient, path: Path):
    pytest.importorskip("rhino3dm")
    answer = client.post("/solve", content=path.read_bytes(), headers=JSON)
    found = answer.json()
    assert answer.status_code == 200 and found["errors"] == []
    assert all(tree["InnerTree"]["{0}"] for tree in found["values"] if tree["ParamName"] != "others")


def with_values(**values: Any) -> str:
    """The recorded sheet with other data of some inputs."""
    kept = [tree for tree in SHEET["values"] if tree["ParamName"] not in values]
    trees = [{"ParamName": name, "InnerTree": {"0": items}} for name, items in values.items()]
    return json.dumps({**SHEET, "values": kept + trees})


def item(data: Any, kind: str = "System.Double") -> dict[str, Any]:
    return {"type": kind, "data": data}


def request(pointer: str, **values: Any) -> str:
    """A request of a component with one value for each input."""
    trees = [{"ParamName": name, "InnerTree": {"0": [item(json.dumps(value))]}} for name, value in values.items()]
    return json.dumps({"pointer": pointer, "values": trees})


BLOB = {"version": 10000, "archive3dm": 70, "opennurbs": -1, "data": "AAAA"}
BAD_DESIGNS = [
    "",
    "[stars]\nlength_mm = 7\n[border]\nfile = '/etc/passwd'\n",
    "[stars]\nlength_mm = { image = '/etc/x.png', low = 1, high = 2, extent_mm = [1, 1] }\n[border]\nrings = 1\n",
    "[stars]\nlength_mm = 7\n[border]\nrings = 1\n[material]\nfile = '/etc/x.toml'\n",
    "[stars]\nlength_mm = 7\n[border]\nrings = 1\n[material]\nlaw = '../law.npz'\n",
    "[stars]\nlength_mm = { formula = '9**9**9**9' }\n[border]\nrings = 1\n",
    "a = " + "[" * 50_000,
]
MALFORMED: list[tuple[str, int]] = [
    ("", 400),
    ("{", 400),
    ("[]", 400),
    ("1e999", 400),
    ("[" * 200_000, 400),
    ('{"pointer": 1}', 400),
    ('{"pointer": "nothing"}', 400),
    ('{"pointer": "__class__", "values": []}', 400),
    ('{"pointer": "sheet"}', 400),
    ('{"pointer": "sheet", "values": [1]}', 400),
    ('{"pointer": "sheet", "values": [{}]}', 500),
    ('{"pointer": "sheet", "values": [{"ParamName": "unknown", "InnerTree": {}}]}', 500),
    ('{"pointer": "sheet", "values": [{"ParamName": ["outline"], "InnerTree": {}}]}', 500),
    ('{"pointer": "sheet", "values": [' + ", ".join(2 * ['{"ParamName": "outline", "InnerTree": {}}']) + "]}", 500),
    ('{"pointer": "sheet", "values": [{"ParamName": "outline", "InnerTree": {"0": 1}}]}', 400),
    (json.dumps({**SHEET, "modelunits": "Parsecs"}), 400),
    (json.dumps({**SHEET, "modelunits": {}}), 400),
    (with_values(lengths=[]), 400),
    (with_values(lengths=[item(7.0)]), 400),
    (with_values(lengths=[item("seven")]), 400),
    (with_values(lengths=[item("NaN")]), 400),
    (with_values(lengths=[item("1e300")]), 400),
    (with_values(lengths=[item("9" * 5000)]), 400),
    (with_values(lengths=5001 * [item("7.0")]), 400),
    (with_values(arms=[item("3.5")]), 400),
    (with_values(stretch=[item("99")]), 400),
    (with_values(search=[item("1")]), 400),
    (with_values(needles=[item("[0, 0, 0]")], targets=[item("[0, 0, 0]")]), 400),
    (with_values(needles=[item('{"X": 0, "Y": 0, "Z": NaN}')], targets=[item('{"X": 0, "Y": 0, "Z": 0}')]), 400),
    (with_values(outline=[item(json.dumps(BLOB))]), 400),
    (with_values(outline=[item(json.dumps({**BLOB, "data": "!" * 99}))]), 400),
    (with_values(outline=[item("[[0, 0, 0], [1, 0, 0], [1e400, 1, 0], [0, 0, 0]]")]), 400),
    (with_values(outline=[item("[[0, 0, 0], [99, 0, 0], [0, 99, 0], [99, 99, 0], [0, 0, 0]]")]), 400),
    (with_values(outline=[item("[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]]")]), 400),
    (request("fit", target=BLOB), 400),
    (request("fit", target={"vertices": [[0, 0, 0], [9, 0, 0], [0, 9, 0]], "faces": [[0, 1, 5]]}), 400),
    *((request("exact", design=design), 400) for design in BAD_DESIGNS),
]


@pytest.mark.parametrize(
    ("body", "status"), MALFORMED, ids=[f"{n} {body[:40]}" for n, (body, _) in enumerate(MALFORMED)]
)
def test_malformed_requests_are_refused_in_one_line(client: TestClient, body: str, status: int):
    pytest.importorskip("rhino3dm")
    answer = client.post("/solve", content=body, headers=JSON)
    found = answer.json()
    assert answer.status_code == status and found["values"] == [] and found["errors"]
    line = found["errors"][-1]
    assert line and "\n" not in line and len(line) < 600 and "root:" not in line and "mistake" not in line
    assert (status == 500) == (found["errors"][0] == "Bad inputs")


@pytest.mark.parametrize(
    "host", ["evil.example:5017", "127.0.0.1", "127.0.0.1:5018", f"{HOST}.evil.example", "[::1]:5017", ""]
)
def test_another_host_is_refused(client: TestClient, host: str):
    for answer in (
        client.get("/sheet", headers={"host": host}),
        client.post("/solve", json=SHEET, headers={"host": host}),
    ):
        assert answer.status_code == 403 and answer.json()["errors"] == ["not allowed"]


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "", f"http://{HOST}", f"https://{HOST}", "file://"])
@pytest.mark.parametrize("path", ["/", "/sheet", "/solve"])
def test_any_page_in_a_browser_is_refused(client: TestClient, path: str, origin: str):
    answer = client.request("POST" if path == "/solve" else "GET", path, headers={"origin": origin, **JSON})
    assert answer.status_code == 403 and "access-control-allow-origin" not in answer.headers


def test_live_connections_are_refused(client: TestClient):
    for path in ("/", "/solve"):
        with pytest.raises(WebSocketDisconnect), client.websocket_connect(f"ws://{HOST}{path}"):
            pass


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data", "", "json"])
def test_only_json_is_read(client: TestClient, kind: str):
    assert client.post("/solve", content=json.dumps(SHEET), headers={"content-type": kind}).status_code == 415


def test_other_methods_are_refused(client: TestClient):
    for method in ("PUT", "DELETE", "PATCH", "OPTIONS", "TRACE"):
        for path in ("/", "/sheet", "/solve"):
            assert client.request(method, path).status_code == 405


def test_other_addresses_lead_nowhere(client: TestClient):
    for path in ("/nothing", "/sheet/", "/../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/sheet%00", "/" + "a" * 5000):
        answer = client.get(path, follow_redirects=False)
        assert answer.status_code in (307, 404) and "root:" not in answer.text


def test_answers_cannot_be_used_by_pages(client: TestClient):
    for path in ("/", "/sheet", "/nothing"):
        headers = client.get(path).headers
        assert headers["content-security-policy"] == "default-src 'none'"
        assert headers["x-content-type-options"] == "nosniff" and headers["cache-control"] == "no-store"


def test_a_key_is_asked_for(tmp_path: Path):
    with TestClient(application(Work(tmp_path), frozenset({HOST}), "secret"), base_url=f"http://{HOST}") as client:
        assert client.get("/sheet").status_code == 200  # some versions of Hops ask for descriptions without the key
        for key in ("", "wrong", "secre", "secrets", "SECRET"):
            refused = client.post("/solve", json=SHEET, headers={"RhinoComputeKey": key})
            assert refused.status_code == 401 and "key" in refused.json()["errors"][0]
        assert client.post("/solve", json=SHEET).status_code == 401
        hops = Hops(client, f"http://{HOST}/sites", headers={"RhinoComputeKey": "secret"})
        assert len(hops.solve(outline=hexagon(1))["sites"]) == 7


def test_requests_that_are_too_large_are_refused_before_they_are_read(client: TestClient):
    sent = 0

    def parts() -> Any:
        nonlocal sent
        for _ in range(100):
            sent += 1_000_000
            yield b" " * 1_000_000

    answer = client.post("/solve", content=parts(), headers=JSON)
    assert answer.status_code == 413 and f"{MAX_REQUEST_BYTES // 1_000_000} MB" in answer.json()["errors"][0]


def test_a_mistake_of_the_server_is_survived(client: TestClient, monkeypatch: pytest.MonkeyPatch):
    def broken(*arguments: Any) -> None:
        raise ZeroDivisionError("inside")

    monkeypatch.setattr(Work, "preview", broken)
    answer = client.post("/solve", json=SHEET)
    assert answer.status_code == 500 and "mistake of asterism" in answer.json()["errors"][0]
    monkeypatch.undo()
    assert client.post("/solve", json=SHEET).status_code == 200


def at_once(work: Work, count: int) -> tuple[list[int], list[Any]]:
    """The order in which so many requests are answered, and their answers."""
    app = application(work, frozenset({HOST}))
    order: list[int] = []

    async def ask(http: httpx2.AsyncClient, number: int) -> Any:
        lengths = [item(str(6.0 + 0.02 * number))]
        answer = await http.post("/solve", content=with_values(lengths=lengths), headers=JSON, timeout=None)
        order.append(number)
        return answer

    async def all_of_them() -> list[Any]:
        transport = httpx2.ASGITransport(app=app)
        async with httpx2.AsyncClient(transport=transport, base_url=f"http://{HOST}") as http:
            return await asyncio.gather(*(ask(http, number) for number in range(count)))

    return order, run_coroutine(all_of_them())


@pytest.mark.slow
def test_many_requests_at_once_are_answered_in_order(tmp_path: Path):
    order, answers = at_once(Work(tmp_path), 20)
    assert order == list(range(20)) and {answer.status_code for answer in answers} == {200}
    designs = [answer.json()["values"][-1]["InnerTree"]["{0}"][0]["data"] for answer in answers]
    assert all(f"length_mm = {6.0 + 0.02 * number:.4g}" in design for number, design in enumerate(designs))


def test_more_requests_than_may_wait_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("asterism.hops.server.MAX_WAITING", 5)
    _, answers = at_once(Work(tmp_path), 8)
    assert [answer.status_code for answer in answers] == 5 * [200] + 3 * [503]


def test_what_nobody_waits_for_is_not_computed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Work, "preview", lambda *arguments: pytest.fail("computed"))
    messages = [{"type": "http.request", "body": json.dumps(SHEET).encode()}, {"type": "http.disconnect"}]
    headers = [(b"host", HOST.encode()), (b"content-type", b"application/json")]
    scope = {"type": "http", "method": "POST", "path": "/solve", "headers": headers, "query_string": b""}
    sent: list[Any] = []

    async def receive() -> Any:
        return messages.pop(0) if len(messages) > 1 else messages[0]

    async def send(message: Any) -> None:
        sent.append(message)

    run_coroutine(application(Work(tmp_path), frozenset({HOST}))(scope, receive, send))
    assert sent[0]["status"] == 400
