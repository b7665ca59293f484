// Copying text, also where the browser has no clipboard for the page (plain HTTP in a network).

import { button } from "./dom.js";

const SHOWN_MS = 1500;

async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const field = document.createElement("textarea");
    field.value = text;
    field.className = "out-of-sight";
    document.body.append(field);
    field.select();
    const done = document.execCommand("copy");
    field.remove();
    return done;
  }
}

/** A button that copies what `text()` returns at the time. */
export function copyButton(name, what, text) {
  const made = button("copy", "Copy", async () => {
    const focused = document.activeElement;
    const done = await copy(text());
    focused?.focus?.({ preventScroll: true });
    made.textContent = done ? "Copied" : "Select it and press Ctrl+C";
    setTimeout(() => (made.textContent = "Copy"), SHOWN_MS);
  }, { "aria-label": `Copy ${what}`, "data-copies": name, class: "small" });
  return made;
}
