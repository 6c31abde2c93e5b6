// Pointers over a canvas: the first one does something, two pinch, one that stays after a pinch moves on.

/**
 * `handlers`: down(event), move(event, [dx, dy]), up(event), cancel(event) while one pointer is pressed, hover(event) and
 * leave(event) while none is, pinch({factor, step, middle}) in px of the window, and wheel(event). `canvas` has the
 * attribute data-pointer from a press to the next key: its focus is not shown.
 */
export function listenToPointers(canvas, { down, move, up, cancel, hover, leave, pinch, wheel }) {
  const pointers = new Map();
  let last = null;
  let isPinch = false;

  function span() {
    const all = [...pointers.values()];
    const middle = [0, 1].map((k) => all.reduce((total, at) => total + at[k], 0) / all.length);
    const length = all.length > 1 ? Math.hypot(all[0][0] - all[1][0], all[0][1] - all[1][1]) : 1;
    return { middle, length: Math.max(length, 1) };
  }
  const put = ({ pointerId, clientX, clientY }) => pointers.set(pointerId, [clientX, clientY]);
  const listen = (names, listener, options) =>
    names.split(" ").forEach((name) => canvas.addEventListener(name, listener, options));

  listen("keydown blur", () => delete canvas.dataset.pointer);
  listen("contextmenu", (event) => event.preventDefault());
  listen("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.dataset.pointer = "";
    canvas.focus({ preventScroll: true });
    put(event);
    if (pointers.size === 1) down(event);
    else if (!isPinch) cancel(event);
    isPinch = pointers.size > 1;
    last = span();
  });
  listen("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return hover(event);
    put(event);
    const [now, before] = [span(), last];
    last = now;
    const step = [0, 1].map((k) => now.middle[k] - before.middle[k]);
    if (isPinch) pinch({ factor: now.length / before.length, step, middle: now.middle });
    else move(event, step);
  });
  listen("pointerup pointercancel", (event) => {
    if (!pointers.delete(event.pointerId)) return;
    if (!isPinch) (event.type === "pointerup" ? up : cancel)(event);
    if (pointers.size) last = span();
    else isPinch = false;
  });
  listen("pointerleave", (event) => pointers.size || leave(event));
  const turn = (event) => (event.preventDefault(), wheel(event));
  listen("wheel", turn, { passive: false });
}
