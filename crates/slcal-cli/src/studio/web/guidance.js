// What is so, what comes next, and the button for it.

import { choose } from "./actions.js";
import { button, el, say, set, show, text } from "./dom.js";
import { pixels } from "./words.js";

/** A click just after a button took the place of another was meant for that one. */
const SETTLE_MS = 350;

/** name: [data-action, label, further attributes] */
const BUTTONS = {
  "open-display": ["open-display", "Open the display window"],
  "use-measured": ["use-measured", "Use the size of the display"],
  "start-webcam": ["start-webcam", "Start the webcam"],
  "go-calibrate": ["go-on", "Go on: calibrate", { "data-step": "calibrate" }],
  "turn-for-me": ["turn-for-me", "Turn the sheet for me"],
  take: ["take", "Take the photograph", { "aria-keyshortcuts": "Space" }],
  "choose-files": ["choose-files", "Choose photographs"],
  "go-scan": ["go-on", "Go on: scan", { "data-step": "scan" }],
  "scan-once": ["scan", "Scan", { "data-mode": "once", "aria-keyshortcuts": "Space" }],
  "scan-start": ["scan", "Scan continuously", { "data-mode": "start" }],
  "scan-stop": ["scan", "Stop", { "data-mode": "stop" }],
  "go-use": ["go-on", "Go on: use it", { "data-step": "use" }],
  "test-picture": ["test-picture", "Project a test picture"],
  "choose-picture": ["choose-picture", "Choose a picture"],
  "show-picture": ["show", "Show the picture", { "data-kind": "picture" }],
  "show-black": ["show", "Take the picture away", { "data-kind": "black" }],
};

const SHOOTING = ["take", "scan-once"];

export function createGuidance(app, handlers) {
  /** One photograph after the other, and nothing while the studio does not answer. */
  const ready = (name) => app.connected() && !(SHOOTING.includes(name) && app.state.busy);
  const sentence = el("p", { class: "sentence", "data-state": "sentence" });
  const next = el("p", { class: "next", "data-state": "next" });
  const busy = el("p", { class: "busy", "data-state": "busy", role: "status" });
  let primary = null;
  let placed = -Infinity; // when the present primary button came to its place
  const buttons = new Map();
  for (const [name, [action, label, attributes]] of Object.entries(BUTTONS)) {
    const press = () => {
      const settled = name !== primary || performance.now() - placed > SETTLE_MS;
      if (settled && ready(name)) handlers[name]();
    };
    buttons.set(name, button(action, label, press, attributes));
  }
  const row = el("div", { class: "actions" }, ...buttons.values());
  show(busy, false);
  row.querySelectorAll("button").forEach((b) => show(b, false));
  const root = el("section", { class: "guidance", "aria-label": "What to do" },
    el("div", { "aria-live": "polite" }, sentence, next), busy, row);

  let before = "";
  const arrange = (state) => {
    const { first, others } = choose(state, app.here());
    const wanted = [first, ...others].filter(Boolean);
    const now = `${first}|${others}`;
    if (now !== before) {
      const focused = document.activeElement;
      for (const [name, b] of buttons) {
        show(b, wanted.includes(name));
        b.classList.toggle("primary", name === first);
      }
      // In the order in which they are seen, for the tab key; the one that has the focus would lose it if it were moved.
      const nodes = wanted.map((name) => buttons.get(name));
      const stays = nodes.indexOf(focused);
      nodes.forEach((b, i) => i !== stays && row.insertBefore(b, i < stays ? focused : null));
      // Whoever works by keyboard stays at the button that comes next.
      if (row.contains(focused) && (focused.hidden || focused === buttons.get(primary))) {
        buttons.get(first ?? wanted[0])?.focus({ preventScroll: true });
      }
      if (primary !== first) placed = performance.now();
      primary = first;
      before = now;
    }
    const viewport = state.display.measured?.viewport;
    if (viewport) text(buttons.get("use-measured"), `Use ${pixels(viewport)}, as the display has`);
    text(buttons.get("open-display"), state.display.connected ? "Show the display window" : "Open the display window");
    text(buttons.get("take"), state.photographs.length > 0 && first !== "take" ? "Take another photograph" : "Take the photograph");
    text(buttons.get("choose-picture"), state.use.picture ? "Choose another picture" : "Choose a picture");
    text(buttons.get("scan-once"), state.scan.clouds.length > 0 ? "Scan again" : "Scan");
    // Not `disabled`, which would take the focus away from whoever has just pressed it.
    for (const [name, b] of buttons) set(b, "aria-disabled", ready(name) ? null : "true");
    show(row, wanted.length > 0);
  };

  return {
    root,
    draw(state) {
      text(sentence, state.sentence);
      // Who only looks on has nothing to do.
      say(next, state.you.operating ? state.next : "");
      show(busy, Boolean(state.busy));
      text(busy, state.busy ? `${state.busy[0].toUpperCase()}${state.busy.slice(1)} …` : "");
      set(root, "data-busy", Boolean(state.busy));
      arrange(state);
    },
    live: () => app.state && arrange(app.state),
    /** For a focus whose place is gone: the next thing to do. False where there is nothing to press. */
    focus() {
      const b = [buttons.get(primary), ...buttons.values()].find((one) => one && !one.hidden);
      b?.focus({ preventScroll: true });
      return Boolean(b);
    },
    /** What the space key does: the photograph or the scan, where there is a button for it. */
    shoot() {
      const name = SHOOTING.find((n) => !buttons.get(n).hidden);
      if (name && ready(name)) handlers[name]();
      return Boolean(name);
    },
  };
}
