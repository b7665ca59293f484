// Step 3: one shot or many, and the clouds that came of them.

import { button, el, keyed, set, show, text } from "./dom.js";
import { withRole } from "./session.js";
import { plural, thousands, told } from "./words.js";

const FORMATS = ["ply", "glb", "pcd", "obj"];

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
        text(points, `${thousands(cloud.points)} points${cloud.triangles ? `, ${thousands(cloud.triangles)} triangles` : ""}`);
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
  const root = el("div", { class: "step-panel", "data-state": "panel", "data-step": "scan" }, kept);
  return {
    root,
    draw(state) {
      const { clouds } = state.scan;
      show(kept, clouds.length > 0);
      text(title, plural(clouds.length, "cloud"));
      drawAll([...clouds].reverse());
    },
  };
}
