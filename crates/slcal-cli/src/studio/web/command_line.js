// The command that does in a terminal what was done here.

import { copyButton } from "./copy.js";
import { el, set, text } from "./dom.js";

export function createCommandLine() {
  let command = "";
  const code = el("code", { "data-state": "command", tabindex: "0", role: "region", "aria-label": "The command that would do the same" });
  const copy = copyButton("command", "the command", () => command);
  const root = el("footer", { class: "command" }, el("span", { class: "prompt", "aria-hidden": "true" }, "$"), code, copy);
  return {
    root,
    draw(state) {
      command = state.command ?? "";
      text(code, command || "# the command that does the same appears here");
      set(root, "data-empty", !command);
      copy.disabled = !command;
    },
  };
}
