// Step 4: a picture that lies straight on the sheet, the report, and the rig for other programs.

import { button, el, keyed, say, set, show, text } from "./dom.js";
import { withRole } from "./session.js";
import { sentence } from "./words.js";

/** Name, what it is, and whether it is several files: those are written into the folder, not downloaded. */
const FORMATS = {
  opencv: ["OpenCV", "YAML for cv2.FileStorage", false],
  npz: ["NumPy", "arrays for Python", false],
  blender: ["Blender", "a script that builds the scene", false],
  kalibr: ["Kalibr", "a camchain", false],
  ros: ["ROS", "camera_info of both devices", true],
  colmap: ["COLMAP", "cameras, images and points", true],
};

/** How the picture lies. Only the demonstration knows whether the sheet was moved since. */
function projected({ picture, straight }) {
  if (straight === false) return "The sheet has moved: the picture was drawn for its last photograph.";
  const lies = `${picture ?? "The picture"} is projected; it lies straight on the sheet`;
  return straight ? `${lies}.` : `${lies} as long as sheet and projector stay where they were when it was photographed.`;
}

export function createUse(app) {
  const status = el("p", { class: "status", "data-state": "picture-shown" });
  const exports = el("ul", { class: "exports" });
  const buttons = [];
  const drawExports = keyed(exports, (f) => f, (format) => {
    const [name, about, several] = FORMATS[format] ?? [format, "", false];
    // The file lies in the folder, too, as everything that is made here.
    const write = () => app.operating() && app.send({ event: "export", format });
    const control = several
      ? button("export", `Write for ${name}`, write, { "data-format": format, class: "small" })
      : el("a", { class: "button small", "data-action": "export", "data-format": format, download: "", onclick: write,
        href: withRole(`/api/exports/${format}`, app.role) }, `Save for ${name}`);
    if (several) buttons.push(control);
    // What came of it stands below its button, where whoever pressed it looks.
    const written = el("p", { "data-state": "exported", "data-format": format });
    const leftOut = el("ul", { "data-state": "left-out", "data-format": format });
    const drawLeftOut = keyed(leftOut, (words) => words, (words) => ({ root: el("li", {}, sentence(words.replace(/^\w+/, name))), draw: () => {} }));
    const answer = el("div", { class: "hint answer", role: "status" }, written, leftOut);
    return {
      root: el("li", {}, control, el("small", {}, about), answer),
      draw() {
        const names = (app.state.use.exported ?? []).filter((file) => file.startsWith(`export-${format}/`));
        const lacking = names.length > 0 ? app.state.use.left_out ?? [] : [];
        say(written, names.length > 0 ? `In the folder now: ${names.join(", ")}.` : "");
        drawLeftOut(lacking);
        show(leftOut, lacking.length > 0);
      },
    };
  });
  const reports = el("ul", { class: "exports" });
  const drawReports = keyed(reports, (r) => r, (path) => ({
    root: el("li", {},
      el("a", { class: "button small", href: withRole(path, app.role), target: "_blank", "data-action": "report" }, "Open the report"),
      el("small", {}, "every number with its uncertainty")),
    draw: () => {},
  }));
  const folder = el("p", { class: "hint", "data-state": "dir" });
  const files = el("section", { class: "part" }, el("h3", {}, "The rig for other programs"), exports, reports, folder);
  const root = el("div", { class: "step-panel", "data-state": "panel", "data-step": "use" },
    el("section", { class: "part" }, el("h3", {}, "A picture on the sheet"), status), files);
  return {
    root,
    draw(state) {
      const { use, display } = state;
      const shown = display.connected && !display.problem && display.wanted?.kind === "picture";
      set(status, "data-value", shown ? (use.straight === false ? "moved" : "shown") : use.picture ? "ready" : "none");
      text(status, shown ? projected(use) : use.picture ? `${use.picture} is ready.`
        : "The rig knows where the sheet is, so that a picture lies straight on it, its sides parallel to those of the sheet.");
      drawExports(use.exports ?? []);
      for (const b of buttons) b.disabled = !state.you.operating;
      drawReports(use.reports ?? []);
      show(files, (use.exports ?? []).length + (use.reports ?? []).length > 0);
      show(folder, Boolean(state.dir));
      text(folder, state.dir ? `Everything lies in ${state.dir}.` : "");
    },
  };
}
