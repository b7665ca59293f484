// The demonstration's sheet is turned by dragging the picture, by the arrow keys, or by sliders.

import { el, set, show } from "./dom.js";

const SEND_MS = 50;
/** What the studio answers while one still moves is old. */
const OWN_MS = 600;
const DEGREES_PER_PICTURE = 110;
const KEY_DEGREES = 3;
const KEY_MM = 10;
const KEY_NEARER = 0.97;
/** Width of what the simulated camera sees at a distance of one. */
const WIDTH_OVER_DISTANCE = 0.88;
const MOST_ASIDE = 400;
const MOST_TILT = 60;
const [NEAREST, FURTHEST] = [500, 2000];
const part = (list, i, v) => list.map((old, k) => (k === i ? v : old));
const tilt = (i) => ({
  unit: "°", min: -MOST_TILT, max: MOST_TILT, step: 1,
  get: (p) => p.tilt_deg[i], put: (p, v) => ({ ...p, tilt_deg: part(p.tilt_deg, i, v) }),
});
const aside = (i) => ({
  unit: " mm", min: -MOST_ASIDE, max: MOST_ASIDE, step: 5,
  get: (p) => p.aside_mm[i], put: (p, v) => ({ ...p, aside_mm: part(p.aside_mm, i, v) }),
});
const FIELDS = [
  { name: "tilt-x", label: "Tilt, top or bottom nearer", ...tilt(0) },
  { name: "tilt-y", label: "Tilt, left or right nearer", ...tilt(1) },
  { name: "aside-x", label: "Left or right", ...aside(0) },
  { name: "aside-y", label: "Up or down", ...aside(1) },
  { name: "roll", label: "Turned in its plane", unit: "°", min: -45, max: 45, step: 1,
    get: (p) => p.roll_deg, put: (p, v) => ({ ...p, roll_deg: v }) },
  { name: "distance", label: "Distance", unit: " mm", min: NEAREST, max: FURTHEST, step: 10,
    get: (p) => p.distance_mm, put: (p, v) => ({ ...p, distance_mm: v }) },
];

const clamp = (v, low, high) => Math.min(high, Math.max(low, v));

export function createDemoScene(app, frame) {
  let pose = null;
  let reached = null; // the outline to which it was turned, until it is moved by hand
  let moved = -Infinity;
  let sent = -Infinity;
  let timer = null;

  const inputs = FIELDS.map((field) => {
    const shown = el("output");
    const input = el("input", { type: "range", min: field.min, max: field.max, step: field.step, "data-action": "turn", "data-field": field.name });
    input.addEventListener("input", () => pose && move(field.put(pose, Number(input.value))));
    const row = el("label", { class: "slider" }, el("span", {}, field.label), input, shown);
    return { field, input, shown, row };
  });
  const objects = ["sheet", "sphere"].map((object) => {
    const input = el("input", { type: "radio", name: "demo-object", value: object, "data-action": "object", "data-object": object });
    input.addEventListener("change", () => app.send({ event: "object", object }));
    return { object, input, row: el("label", { class: "choice" }, input, el("span", {}, object === "sheet" ? "The sheet" : "A sphere")) };
  });
  const what = el("div", { class: "choices", role: "radiogroup", "aria-label": "What stands before the camera" }, ...objects.map((o) => o.row));
  const hint = el("p", { class: "hint" }, "Drag the picture to turn the sheet.", el("span", { class: "by-mouse" },
    " With Shift or the right button it moves, by the wheel it comes nearer. By keyboard: arrow keys, with Shift, + and −."));
  const sliders = el("details", {}, el("summary", {}, "Turn it by sliders"), ...inputs.map((i) => i.row));
  const root = el("section", { class: "part demo-scene", "data-state": "demo-scene" }, el("h3", {}, "The simulated scene"), what, hint, sliders);

  function drawPose() {
    for (const { field, input, shown } of inputs) {
      const v = Math.round(field.get(pose));
      if (Number(input.value) !== v) input.value = String(v);
      const written = `${v}${field.unit}`.replace("-", "−");
      if (shown.value !== written) shown.value = written;
    }
  }

  function send() {
    timer = null;
    sent = performance.now();
    app.send({ event: "turn", ...pose });
  }

  function move(to) {
    pose = {
      ...to,
      tilt_deg: to.tilt_deg.map((v) => clamp(v, -MOST_TILT, MOST_TILT)),
      roll_deg: clamp(to.roll_deg, -45, 45),
      distance_mm: clamp(to.distance_mm, NEAREST, FURTHEST),
      aside_mm: to.aside_mm.map((v) => clamp(v, -MOST_ASIDE, MOST_ASIDE)),
    };
    moved = performance.now();
    reached = null;
    drawPose();
    timer ??= setTimeout(send, Math.max(0, sent + SEND_MS - moved));
  }

  const active = () => Boolean(app.state?.demo_scene && app.operating() && app.state.demo_scene.object === "sheet");
  const turned = (from, right, down) => ({ ...from, tilt_deg: [from.tilt_deg[0] + down, from.tilt_deg[1] - right] });
  const shifted = (from, right, down) => ({ ...from, aside_mm: [from.aside_mm[0] + right, from.aside_mm[1] + down] });

  let grip = null;
  frame.addEventListener("pointerdown", (event) => {
    if (!active() || ![0, 2].includes(event.button) || event.target.closest("button")) return;
    frame.setPointerCapture(event.pointerId);
    grip = { x: event.clientX, y: event.clientY, pose, moves: event.shiftKey || event.button === 2 };
  });
  frame.addEventListener("pointermove", (event) => {
    if (!grip) return;
    const scale = (grip.moves ? WIDTH_OVER_DISTANCE * grip.pose.distance_mm : DEGREES_PER_PICTURE) / frame.clientWidth;
    const by = [(event.clientX - grip.x) * scale, (event.clientY - grip.y) * scale];
    move(grip.moves ? shifted(grip.pose, ...by) : turned(grip.pose, ...by));
  });
  frame.addEventListener("contextmenu", (event) => active() && event.preventDefault());
  const release = () => (grip = null);
  frame.addEventListener("pointerup", release);
  frame.addEventListener("pointercancel", release);
  frame.addEventListener("wheel", (event) => {
    if (!active()) return;
    event.preventDefault();
    move({ ...pose, distance_mm: pose.distance_mm * Math.exp(event.deltaY * 0.0005) });
  }, { passive: false });
  frame.addEventListener("keydown", (event) => {
    if (!active() || event.target !== frame || event.ctrlKey || event.altKey || event.metaKey) return;
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const nearer = { "+": KEY_NEARER, "=": KEY_NEARER, "-": 1 / KEY_NEARER }[event.key];
    if (!way && !nearer) return;
    event.preventDefault();
    if (nearer) move({ ...pose, distance_mm: pose.distance_mm * nearer });
    else if (event.shiftKey) move(shifted(pose, ...way.map((v) => v * KEY_MM)));
    else move(turned(pose, ...way.map((v) => v * KEY_DEGREES)));
  });

  return {
    root,
    draw(state) {
      const scene = state.demo_scene;
      show(root, Boolean(scene));
      frame.classList.toggle("turnable", active());
      set(frame, "tabindex", active() ? "0" : null);
      set(frame, "role", active() ? "group" : null);
      set(frame, "aria-label", active()
        ? "Picture of the simulated camera: arrow keys turn the sheet, with Shift they move it, plus and minus bring it nearer or further"
        : null);
      if (!scene) return;
      for (const { object, input } of objects) input.checked = scene.object === object;
      for (const { input } of [...objects, ...inputs]) input.disabled = !state.you.operating;
      show(what, state.step === "scan" || state.step === "use");
      show(hint, scene.object === "sheet");
      show(sliders, scene.object === "sheet");
      if (pose === null || performance.now() - moved > OWN_MS) {
        const { object, ...now } = scene;
        pose = { aside_mm: [0, 0], ...now };
        drawPose();
      }
    },
    /** Onto the dashed outline. */
    turnTo(guide) {
      moved = -Infinity;
      reached = String(guide.quad);
      app.send({ event: "turn", ...guide.turn });
    },
    turned: (guide) => guide !== null && reached === String(guide.quad),
  };
}
