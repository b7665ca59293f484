// Who else is here, and who operates.

import { button, el, say, set, show, text } from "./dom.js";
import { plural } from "./words.js";

export function createPeople(app) {
  const count = el("p", { class: "people", "data-state": "others" });
  const banner = el("p", { "data-state": "role" });
  const take = button("take-over", "Take over", () => app.send({ event: "take-over" }), { class: "primary" });
  const root = el("div", { class: "banner", role: "status" }, banner, take);
  show(root, false);
  return {
    count,
    root,
    draw({ you, others }) {
      const watching = you.role === "watcher";
      set(banner, "data-value", watching ? "watcher" : you.operating ? "operating" : "waiting");
      show(root, !you.operating);
      text(banner, watching
        ? "You are watching. You see everything; nothing that you press here changes anything."
        : you.operating ? "" : "Someone else operates this studio. You see everything; to change something, take over.");
      show(take, !watching && !you.operating);
      const words = [
        others.displays > 1 ? plural(others.displays, "display") : null,
        others.watchers ? plural(others.watchers, "watcher") : null,
      ];
      say(count, words.filter(Boolean).join(", "));
    },
  };
}

/** The connection to the studio, told only while it is lost. */
export function createLink() {
  const words = el("p");
  const root = el("div", { class: "banner lost", role: "alert", "data-state": "connection", "data-value": "up" }, words);
  show(root, false);
  return {
    root,
    link({ up, ended, retryMs }) {
      set(root, "data-value", up ? "up" : ended ? "ended" : "lost");
      show(root, !up);
      if (ended) {
        text(words, "The studio was started anew and does not know this page any more. Open the address that it printed; everything that was made is still there.");
      } else if (!up) {
        text(words, `The studio does not answer. Trying again${retryMs >= 1000 ? ` in ${Math.round(retryMs / 1000)} s` : ""}; nothing that was made is lost.`);
      }
    },
  };
}
