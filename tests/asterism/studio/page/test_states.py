"""The state of the shape on the page: one statement, and the exact shape that follows a stroke."""

from __future__ import annotations

import json

from tests.asterism.studio.browser import VIEWPORT, StudioPage
from tests.asterism.studio.test_badge import MATRIX


def test_whatever_speaks_of_the_shape_says_the_words_of_the_badge_and_the_form_of_a_print(shared: StudioPage) -> None:
    page = shared
    page.open("gallery-star")
    (socket,) = page.live_sockets()
    page.wait("studio.state.release?.is_same === true")  # the last message of the server's own
    page.item("tab-shape").click()
    assert "takes this form too" in page.item("release").inner_text()
    state = page.get("studio.state")
    for kind, words, is_stale, _ in dict.fromkeys(statement for _, statement in MATRIX.values()):
        badge = {**state["badge"], "kind": kind, "words": words, "is_stale": is_stale}
        socket.send(json.dumps({**state, "badge": badge}))
        page.wait(f"studio.badge.words === {words!r} && studio.badge.isStale === {str(is_stale).lower()}")
        assert page.item("badge-words").inner_text() == page.item("footer-state").inner_text() == words
        assert page.item("trust").inner_text().startswith(words)
        assert page.get("studio.pictureTitle").endswith(f"· {words}")
        page.wait(f"studio.isGrey === {str(is_stale).lower()}")
        page.item("export").click()
        assert page.item("export-dialog").inner_text().count(words) == 1
        page.page.keyboard.press("Escape")
    # what the server says of a frame that has not come is not said of the one that is drawn
    socket.send(json.dumps({**state, "badge": {**state["badge"], "revision": 99}}))
    page.wait("studio.badge.words === 'Computing'")

    release = {"is_same": False, "energy_percent": -0.4, "apart_percent": 5.2, "is_shown": False}
    socket.send(json.dumps({**state, "release": release}))
    page.wait("document.querySelector('[data-testid=show-released]')")
    assert "energy -0.4 %" in page.item("exact-form-released").inner_text().replace("\u2212", "-")
    socket.send(json.dumps({**state, "release": {**release, "is_shown": True}}))
    page.wait("!document.querySelector('[data-testid=show-released]')")
    assert "energy +0.4 %" in page.item("exact-form-preview").inner_text()


def test_open_dialogs_follow_the_shape_and_a_job_counts_its_seconds(shared: StudioPage) -> None:
    page = shared
    page.open("gallery-star")
    (socket,) = page.live_sockets()
    page.wait("studio.state.release?.is_same === true")
    exact = page.get("studio.state")
    preview = {**exact, "badge": {**exact["badge"], "kind": "preview", "words": "Preview, about 1.3 %"}}
    socket.send(json.dumps(preview))
    page.wait("studio.badge.kind === 'preview'")
    page.item("picture").click()
    assert page.item("animate").is_disabled()
    socket.send(json.dumps(exact))
    page.wait("studio.badge.kind === 'exact'")
    assert page.item("animate").is_enabled()
    page.page.keyboard.press("Escape")
    page.item("export").click()
    socket.send(json.dumps(preview))
    page.wait("studio.badge.kind === 'preview'")
    assert preview["badge"]["words"] in page.item("export-dialog").inner_text()
    page.page.keyboard.press("Escape")

    progress = {"type": "progress", "job": "export", "stage": "export", "done": 0, "of": 0, "seconds": 0.0}
    socket.send(json.dumps(progress))
    page.wait("/^Writing files … [1-9]/.test(document.querySelector('[data-testid=job]').textContent)")
    socket.send(json.dumps({"type": "result", "job": "export", "cancelled": True}))
    page.wait("!document.querySelector('[data-testid=cancel]').offsetParent")

    settling = {"seconds": 3.0, "about_s": 9.5}
    socket.send(json.dumps({**preview, "settling": settling}))
    for name in ("engine", "badge"):
        page.wait(f"document.querySelector('[data-testid={name}]').textContent.includes('about 6 s left')")
    socket.send(json.dumps({**preview, "settling": {**settling, "seconds": 30.0}}))
    for name in ("engine", "badge"):
        page.wait(f"document.querySelector('[data-testid={name}]').textContent.includes('31 s so far')")
    socket.send(json.dumps({**preview, "settling": {**settling, "about_s": 600.0}}))
    page.wait("document.querySelector('[data-testid=badge]').textContent.includes('about 9 min 57 s left')")

    # the number of the warnings leads to them, wherever the panel is scrolled to
    page.page.set_viewport_size({"width": 1280, "height": 480})
    socket.send(json.dumps({**exact, "warnings": [{"text": "The needles lean", "stars": [], "at_mm": None}]}))
    page.item("warnings").click()
    bottom = page.get("document.querySelector('[data-testid=warning-list]').getBoundingClientRect().bottom")
    assert bottom < page.get("document.querySelector('[data-testid=warnings]').getBoundingClientRect().top")
    page.page.set_viewport_size(VIEWPORT)


def test_the_sheet_settles_after_a_stroke_and_is_shown_beside_its_preview(shared: StudioPage) -> None:
    shared.open("file-seven.toml")
    shared.wait("studio.badge.kind === 'exact' && studio.isBeside")
    first = shared.get("studio.height")
    shared.item("shown-distance").click()
    shared.wait("!document.querySelector('[data-testid=legend]').hidden && studio.contours > 0")
    assert "Exact shape to preview" in shared.item("legend").inner_text()
    assert shared.item("view-colour").is_disabled()
    shared.item("shown-shape").click()
    shared.wait("document.querySelector('[data-testid=legend]').hidden && studio.contours === 0")
    shared.item("tool-brush").click()
    # an exact shape is said of the design that is shown, and never beside one that is still to come
    footer = "document.querySelector('[data-testid=engine]').textContent"
    shared.get(
        "void (window.stale = [], setInterval(() => studio.badge.kind === 'exact'"
        f" && (studio.shownRevision !== studio.revision || /Exact shape/.test({footer}))"
        f" && window.stale.push({footer}), 1))"
    )
    shared.changed(lambda: shared.drag((-20.0, 0.0), (20.0, 5.0)))
    shared.wait("studio.badge.kind === 'exact'")
    assert shared.get("studio.height") != first
    for smooth in ("studio.isSmooth", "!studio.isSmooth"):
        shared.item("show-bumps").click()
        shared.wait(smooth)
    shared.changed(lambda: shared.item("undo").click())
    shared.wait("studio.badge.kind === 'exact'")
    assert shared.get("window.stale") == []
    assert shared.item("footer-state").inner_text().startswith("Exact, mesh error")
