// Contents that are built anew while the keyboard is among them.

import { replace } from "./dom.js";

// fields in which something is typed that is not accepted yet
addEventListener("input", ({ target }) => target.dataset && (target.dataset.typed = "true"), true);
addEventListener("change", ({ target }) => delete target.dataset?.typed, true);

/**
 * Replaces the content when the keyboard has moved on: a field that is left by Tab changes before the next one has the
 * focus. That one keeps the focus and what is typed in it; elements are the same if they have the same testid.
 */
export function rebuild(element, build) {
  setTimeout(() => {
    const before = element.contains(document.activeElement) ? document.activeElement : null;
    replace(element, build());
    const after = before?.dataset.testid && element.querySelector(`[data-testid="${before.dataset.testid}"]`);
    if (!after) return;
    after.focus();
    if (!before.dataset.typed) return void after.select?.();
    after.value = before.value;
    after.dataset.typed = "true";
    after.setSelectionRange(before.selectionStart, before.selectionEnd);
    // a browser reports a change only of what was typed into this very element
    const leave = () => after.dataset.typed && after.dispatchEvent(new Event("change", { bubbles: true }));
    after.addEventListener("blur", leave, { capture: true, once: true });
  });
}
