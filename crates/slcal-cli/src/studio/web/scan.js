// Step 3: one photograph or a sequence of them, how far that is, and the clouds that came of them.

import { button, el, keyed, say, set, show, text } from "./dom.js";
import { withRole } from "./session.js";
import { plural, thousands, told } from "./words.js";

const FORMATS = ["ply", "glb", "pcd", "obj"];

const METHODS = [
  { method: "stripes", label: "One shot: stripes", about: "A point per stripe and row, of what moves, too." },
  { method: "gray", label: "Many shots: Gray code", about: "A point per pixel. Nothing may move; any colour." },
  { method: "phase", label: "Many shots: phase shift", about: "The same, and more precise: for measuring." },
];

function createMethod(app) {
  const rows = METHODS.map(({ method, label, about }) => {
    const input = el("input", { type: "radio", name: "scan-method", value: method, "data-action": "scan-method", "data-method": method });
    input.addEventListener("change", () => app.send({ event: "scan-method", method }));
    return { method, input, row: el("label", { class: "choice wide" }, input, el("span", {}, label, el("small", {}, about))) };
  });
  const group = el("div", { role: "radiogroup", "aria-label": "How to scan" }, ...rows.map((r) => r.row));
  const fields = el("fieldset", { class: "bare" }, group);
  const light = el("p", { class: "hint", "data-state": "exposure" });
  const root = el("section", { class: "part" }, el("h3", {}, "How to scan"), fields, light);
  return {
    root,
    draw(state) {
      const { method, continuous, shots } = state.scan;
      fields.disabled = !app.operating() || continuous || Boolean(shots);
      for (const r of rows) r.input.checked = r.method === method;
      const adapts = state.camera.kind === "webcam" && !(state.camera.held ?? []).includes("exposure");
      say(light, method === "stripes" ? "" : adapts
        ? "This camera does not hold its exposure: switch the automatic one off in its own settings. Frames of different exposure cannot be compared."
        : "Fix exposure, gain, white balance and focus of the camera.");
      show(light, method !== "stripes" && !state.demo);
    },
  };
}

function createProgress() {
  const bar = el("progress", { "aria-label": "Photographs of the sequence" });
  const words = el("p", { class: "figures", "data-state": "shots", role: "status" });
  const root = el("section", { class: "part shots" }, words, bar);
  return {
    root,
    draw({ scan: { shots }, camera }) {
      show(root, Boolean(shots));
      if (!shots) return;
      set(bar, "max", shots.of);
      bar.value = Math.max(0, shots.frame - 1);
      set(words, "data-frame", shots.frame);
      set(words, "data-of", shots.of);
      const delay = camera.latency_ms === null || shots.by_hand ? "" : ` The camera shows a picture after ${camera.latency_ms} ms.`;
      text(words, shots.frame === 0 ? `${shots.of} pictures; first the camera's delay.` : `Picture ${shots.frame} of ${shots.of}.${delay}`);
    },
  };
}

export function createScan(app) {
  const list = el("ul", { class: "clouds" });
  const drawAll = keyed(list, (c) => c.id, ({ id }) => {
    const look = button("cloud", "", () => app.pickCloud(id), { class: "look", "data-id": id });
    const image = el("img", { alt: "", loading: "lazy" });
    const name = el("span", { class: "file" });
    const points = el("span", { class: "figures" });
    look.append(image, el("span", { class: "about" }, name, points));
    const links = FORMATS.map((format) => el("a", { "data-action": "save", "data-format": format, download: "" }, format.toUpperCase()));
    const warnings = el("p", { class: "advice" });
    const again = button("reconstruct", "Compute it again", () => app.send({ event: "reconstruct", id }), { class: "small", "data-id": id });
    const outdated = el("p", { class: "advice", "data-state": "cloud-outdated", "data-id": id }, "Made with an earlier calibration. ", again);
    const root = el("li", { "data-state": "cloud-file", "data-id": id }, look, el("p", { class: "saves" }, "Save as ", ...links.flatMap((a) => [a, " "])), outdated, warnings);
    return {
      root,
      draw(cloud) {
        text(name, cloud.name);
        const of = cloud.frames ? `, from ${plural(cloud.frames, "photograph")}` : "";
        text(points, `${thousands(cloud.points)} points${cloud.triangles ? `, ${thousands(cloud.triangles)} triangles` : ""}${of}`);
        const url = cloud.photo ? withRole(cloud.photo, app.role) : null;
        if (url && image.getAttribute("src") !== url) image.src = url;
        show(image, Boolean(url));
        set(look, "aria-pressed", String(!app.state.scan.live && app.pickedCloud() === id));
        for (const a of links) {
          set(a, "href", withRole(`${cloud.url}.${a.dataset.format}`, app.role));
          set(a, "aria-label", `Save ${cloud.name} as ${a.dataset.format.toUpperCase()}`);
        }
        show(outdated, Boolean(cloud.outdated));
        show(again, app.operating());
        text(warnings, (cloud.warnings ?? []).map((w) => (typeof w === "string" ? w : told(w))).join(" "));
        show(warnings, (cloud.warnings ?? []).length > 0);
      },
    };
  });
  const title = el("h3", {}, "Clouds");
  const kept = el("section", { class: "part" }, title, list);
  const method = createMethod(app);
  const progress = createProgress();
  const left = el("ul", { class: "unfinished" });
  const drawLeft = keyed(left, (u) => u.name, () => {
    const root = el("li", { class: "advice", "data-state": "unfinished" });
    return {
      root,
      draw(scan) {
        set(root, "data-name", scan.name);
        text(root, `${scan.name} was not finished: ${scan.have} of ${plural(scan.of, "photograph")}. It is not used, and its folder may be deleted.`);
      },
    };
  });
  const root = el("div", { class: "step-panel", "data-state": "panel", "data-step": "scan" }, progress.root, method.root, kept, left);
  return {
    root,
    draw(state) {
      const { clouds, unfinished } = state.scan;
      method.draw(state);
      progress.draw(state);
      drawLeft(unfinished ?? []);
      show(left, (unfinished ?? []).length > 0);
      show(kept, clouds.length > 0);
      text(title, plural(clouds.length, "cloud"));
      drawAll([...clouds].reverse());
    },
  };
}
