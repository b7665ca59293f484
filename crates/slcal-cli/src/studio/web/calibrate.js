// Step 2: photographs of the sheet under the checkerboard, each from the pose that teaches most.

import { el, say, set, show, text } from "./dom.js";
import { createPhone } from "./set_up.js";
import { createTiles } from "./tiles.js";
import { createVerdict } from "./verdict.js";
import { sentence } from "./words.js";

const FOCAL = "The lengths that the calibration gives are as accurate as these: 0.1 % is 1 mm in 1 m (one standard deviation)";

/** What a photograph brings, in plain words; "" where it would change no figure. */
function gainOf({ gain, needed }) {
  const [, before, after] = /([\d.]+ %) → ([\d.]+ %)/.exec(gain) ?? [];
  if (before && before === after) return "";
  const [, about] = /about ([\d.]+ %) with a second/.exec(gain) ?? [];
  if (about) return `With a second photograph, tilted the other way: accuracy of the focal lengths about ${about}`;
  const what = before ? `accuracy of the focal lengths ${before} → ${after}` : gain;
  return `${needed ? "The next photograph brings" : "Another photograph would bring"}: ${what}`;
}

export function createCalibrate(app) {
  const auto = el("input", { type: "checkbox", "data-action": "auto-shot" });
  auto.addEventListener("change", () => app.send({ event: "auto-shot", on: auto.checked }));
  const autoRow = el("label", { class: "choice" }, auto, el("span", {}, "Take it by itself, when the sheet is near the dashed outline, sharp and still"));
  const scale = el("input", { type: "range", min: 20, max: 120, step: 5, "data-action": "set-up", "data-field": "pattern-scale" });
  const scaleShown = el("output");
  scale.addEventListener("input", () => text(scaleShown, `${scale.value} %`));
  scale.addEventListener("change", () => {
    const { projector, size } = app.state.set_up;
    app.send({ event: "set-up", projector, size, pattern_scale: Number(scale.value) / 100 });
  });
  const scaleRow = el("label", { class: "slider", "data-state": "pattern-scale" }, el("span", {}, "Size of the checkerboard"), scale, scaleShown);
  const gain = el("p", { class: "gain", "data-state": "gain", title: FOCAL });
  const details = el("p", { class: "hint", "data-state": "pose" });
  const phone = createPhone(app);
  const verdict = createVerdict(app);
  const tiles = createTiles(app);
  const fields = el("fieldset", { class: "bare" }, el("div", {}, gain, details), autoRow, scaleRow);
  const root = el("div", { class: "step-panel", "data-state": "panel", "data-step": "calibrate" }, fields, phone.root, verdict.root, tiles.root);
  return {
    root,
    draw(state) {
      fields.disabled = !state.you.operating;
      auto.checked = state.auto_shot;
      show(autoRow, ["webcam", "demo"].includes(state.camera.kind));
      say(gain, state.guide?.gain ? gainOf(state.guide) : "");
      say(details, state.guide?.needed ? sentence(state.guide.details) : "");
      set(gain, "data-value", state.guide?.needed ? "needed" : "optional");
      // Another pattern would contradict photographs that were taken already. The simulated sheet is as large as it should be.
      const beside = app.live?.problem?.code === "pattern-beside-sheet";
      show(scaleRow, state.photographs.length === 0 && typeof state.set_up.pattern_scale === "number" && (!state.demo || beside));
      if (document.activeElement !== scale) {
        scale.value = String(Math.round(100 * (state.set_up.pattern_scale ?? 1)));
        text(scaleShown, `${scale.value} %`);
      }
      phone.draw(state);
      verdict.draw(state);
      tiles.draw(state);
    },
  };
}
