"""What an edit costs in the studio's page, with drawing in software: from a key to the drawn picture.

python -m benchmarks.studio_drawing

A key changes the length of one star. For each design the median and the 95 % quantile, in milliseconds by the clock,
from the key to the drawn linear response (the first picture) and to the drawn equilibrium, and of one drawing alone,
whose pixels are read back; of that also the processor time of all processes of the browser (Linux). Chromium draws by
SwiftShader, on the same cores that compute.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright

from benchmarks.report import markdown, write_report
from tests.asterism.studio.browser import ARGUMENTS, VIEWPORT, StudioPage, browser_path, running_studio

DESIGNS = ("dome", "u-shape")
EDITS = 12
WARM_UP = 3
PRESS = """async (key) => {
    const [before, drawn] = [studio.revision, studio.drawn];
    const target = document.getElementById("plan-canvas");
    const next = () => new Promise((resolve) => setTimeout(resolve));
    const begun = performance.now();
    target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    const isShown = () => studio.revision > before && studio.shownRevision === studio.revision && studio.drawn > drawn;
    while (!isShown()) await next();
    const first = performance.now() - begun;
    const count = studio.drawn;
    if (studio.stage === "linear") while (!(studio.stage === "equilibrium" && studio.drawn > count)) await next();
    return [first, performance.now() - begun];
}"""
DRAW = """() => {
    const gl = document.getElementById("view-canvas").getContext("webgl2");
    const pixel = new Uint8Array(4);
    const begun = performance.now();
    studio.draw();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    return performance.now() - begun;
}"""


def browser_seconds() -> float:
    """Processor time of the browser's processes that this one has started."""
    parents, seconds = dict[int, int](), dict[int, float]()
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            name, _, rest = entry.read_text().partition("(")[2].rpartition(")")
        except OSError:
            continue  # it has ended
        fields = rest.split()
        parents[int(entry.parent.name)] = int(fields[1])
        if name.startswith("chrom"):
            ticks = sum(int(field) for field in fields[11:13])
            seconds[int(entry.parent.name)] = ticks / os.sysconf("SC_CLK_TCK")
    return sum(spent for process, spent in seconds.items() if is_below(process, os.getpid(), parents))


def is_below(process: int, ancestor: int, parents: dict[int, int]) -> bool:
    """Whether a process descends from another."""
    while process in parents and process != ancestor:
        process = parents[process]
    return process == ancestor


def measure(page: StudioPage, name: str) -> dict[str, object]:
    """Times (ms) of one design."""
    page.open(f"gallery-{name}")
    page.summarised()
    page.page.locator("#plan-canvas").focus()
    page.page.keyboard.press("ArrowRight")
    times = []
    for k in range(WARM_UP + EDITS):
        times.append(page.page.evaluate(PRESS, "+" if k % 4 < 2 else "-"))
        page.rest()
    for _ in range(WARM_UP):
        page.page.evaluate(DRAW)
    spent = browser_seconds()
    drawings = [page.page.evaluate(DRAW) for _ in range(EDITS)]
    spent = browser_seconds() - spent
    first, final = np.array(times[WARM_UP:]).T
    row: dict[str, object] = {"design": name, "stars": page.get("studio.sizes.length"), "count": EDITS}
    for label, values in (("first", first), ("equilibrium", final), ("drawing", np.array(drawings))):
        row |= {f"{label}_ms": float(np.median(values)), f"{label}_95_ms": float(np.quantile(values, 0.95))}
    return row | {"drawing_processor_ms": 1000.0 * spent / EDITS}


def main() -> None:
    load = [os.getloadavg()[0]]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=browser_path(), args=list(ARGUMENTS))
        with running_studio(Path(folder)) as url:
            page = StudioPage(browser.new_context(viewport=VIEWPORT).new_page(), url)
            rows = [measure(page, name) for name in DESIGNS]
        browser.close()
    load.append(os.getloadavg()[0])
    columns = [key for key in rows[0] if key.endswith("_ms")]
    header = ["design", "stars", "count"]
    header += [key.replace("_95_ms", " 95 %").replace("_", " ") for key in columns]
    lines = [[*(str(row[key]) for key in header[:3]), *(f"{row[key]:.0f}" for key in columns)] for row in rows]
    table = markdown(header, lines)
    note = (
        f"A window of {VIEWPORT['width']} x {VIEWPORT['height']}, drawn by SwiftShader. "
        f"Load average of the {os.cpu_count()} cores before and after: {load[0]:.1f}, {load[1]:.1f}. "
        "Above one process a core, times by the clock are longer than on an idle machine."
    )
    write_report("studio_drawing", rows, f"{note}\n\n{table}")
    print(note, table, sep="\n")


if __name__ == "__main__":
    main()
