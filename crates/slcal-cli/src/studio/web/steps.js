// The four steps, always in view; each can be left and returned to.

import { button, el, set, text } from "./dom.js";

const NAMES = { "set-up": "Set up", calibrate: "Calibrate", scan: "Scan", use: "Use" };
/** Why a step cannot be entered by who only looks on. */
const OTHERS = "Only who operates the studio goes from step to step; this page follows.";
const STATES = { done: "done", current: "", open: "", locked: "not yet possible" };

export function createSteps(app) {
  const parts = Object.entries(NAMES).map(([step, name], i) => {
    const sign = el("span", { class: "sign", "aria-hidden": "true" }, String(i + 1));
    const note = el("span", { class: "out-of-sight" });
    const b = button("step", "", () => {
      if (!app.operating()) return;
      const known = app.state?.steps.find((s) => s.step === step);
      if (known?.state === "locked") app.note(known.why ?? `${name} is not possible yet.`);
      else app.send({ event: "step", step });
    }, { "data-step": step, "data-state": "step" });
    b.append(sign, el("span", { class: "name" }, name), note);
    return { step, b, sign, note, number: String(i + 1) };
  });
  const root = el("nav", { class: "steps", "aria-label": "Steps" },
    el("ol", {}, ...parts.map(({ b }) => el("li", {}, b))));
  return {
    root,
    focus: () => parts.find(({ b }) => b.hasAttribute("aria-current"))?.b.focus({ preventScroll: true }),
    draw(state) {
      for (const { step, b, sign, note, number } of parts) {
        const known = state.steps.find((s) => s.step === step) ?? { state: "open" };
        const current = state.step === step;
        set(b, "data-value", known.state);
        set(b, "aria-current", current ? "step" : null);
        // Not `disabled`: a locked step can be asked why it is locked.
        set(b, "aria-disabled", known.state === "locked" || !state.you.operating ? "true" : null);
        const why = !state.you.operating ? (current ? null : OTHERS) : known.state === "locked" ? known.why : null;
        set(b, "title", why);
        set(b, "aria-description", why);
        text(sign, known.state === "done" && !current ? "✓" : number);
        text(note, STATES[known.state] ? `, ${STATES[known.state]}` : "");
      }
    },
  };
}
