// Step 1: the projector's pixels, the sheet's size, the display window and the camera.

import { copyButton } from "./copy.js";
import { button, el, keyed, say, set, show, text, value } from "./dom.js";
import { parsePixels, pixels, told } from "./words.js";

const INTRODUCTION = "You need a flat, white, rectangular sheet: a second window, the display window, has the projector throw a checkerboard onto it, " +
  "whose corners the camera measures.";
const IN_DEMO = "Here projector, sheet and camera are simulated.";
const CAMERAS = [
  { kind: "demo", label: "Simulated camera", about: "sees what the display window shows" },
  { kind: "webcam", label: "Webcam of this computer", about: "live, photographs taken by itself" },
  { kind: "phone", label: "Phone or tablet", about: "takes photographs and sends them over the network" },
  { kind: "folder", label: "Folder", about: "a camera with a cable saves its photographs there" },
  { kind: "files", label: "Files", about: "drop photographs on this page" },
];
const PANELS = ["1024x768", "1280x720", "1280x800", "1366x768", "1920x1080", "1920x1200", "2560x1600", "3840x2160"];
const SHOWN = [["marks", "Corner marks"], ["white", "White"], ["checker", "Checkerboard"], ["black", "Black"]];

function createSettings(app) {
  const projector = el("input", { id: "projector", "data-action": "set-up", "data-field": "projector", list: "panels", autocomplete: "off",
    spellcheck: "false", "aria-describedby": "projector-hint projector-problem", placeholder: "1920x1080" });
  const size = el("input", { id: "size", "data-action": "set-up", "data-field": "size", autocomplete: "off",
    spellcheck: "false", "aria-describedby": "size-hint size-problem", placeholder: "297x210mm" });
  const fields = { projector, size };
  const problem = (field) => el("p", { class: "wrong", role: "alert", id: `${field}-problem`, "data-state": `${field}-problem` });
  const problems = { projector: problem("projector"), size: problem("size") };
  const typed = new Set(); // fields whose text is not yet known to be accepted
  let noPixels = ""; // what is wrong with the pixels before they are sent
  const known = el("div", { class: "choices", role: "group", "aria-label": "Usual sizes" });
  const drawKnown = keyed(known, (name) => name, (name) => ({
    root: button("size", name, () => {
      size.value = name;
      tell("size");
    }, { "data-size": name, class: "small" }),
    draw: () => {},
  }));

  function tell(field) {
    typed.add(field);
    const panel = projector.value.trim() === "" ? null : parsePixels(projector.value);
    const wrong = projector.value.trim() !== "" && panel === null;
    noPixels = wrong ? "Type width x height in pixels, such as 1920x1080." : "";
    if (wrong) draw(app.state);
    else app.send({ event: "set-up", projector: panel, size: size.value.trim() || null });
  }
  for (const [field, input] of Object.entries(fields)) {
    input.addEventListener("change", () => tell(field));
    input.addEventListener("keydown", (event) => event.key === "Enter" && input.blur());
  }

  const root = el("div", { class: "pairs" },
    el("div", { class: "field" }, el("label", { for: "projector" }, "Projector, pixels"), projector,
      el("p", { class: "hint", id: "projector-hint" }, "Native resolution."),
      el("datalist", { id: "panels" }, ...PANELS.map((p) => el("option", { value: p })))),
    el("div", { class: "field" }, el("label", { for: "size" }, "Sheet, width x height"), size,
      el("p", { class: "hint", id: "size-hint" }, "Measure it with a ruler.")),
    problems.projector, problems.size, known);

  function draw({ set_up: settings }) {
    const { problem } = settings;
    const ofSize = problem?.code?.includes("size");
    const ofProjector = problem && !ofSize && problem.code !== "set-up-pattern"; // The pattern's size is told where it is set.
    const wrong = { projector: noPixels || (ofProjector ? told(problem) : ""), size: ofSize ? told(problem) : "" };
    const accepted = { projector: pixels(settings.projector), size: settings.size ?? "" };
    // As long as something is wrong nothing is accepted: all stays as it was typed, to be mended.
    if (!wrong.projector && !wrong.size) typed.clear();
    for (const [field, input] of Object.entries(fields)) {
      if (!typed.has(field)) value(input, accepted[field]);
      set(input, "data-missing", !accepted[field] && input.value.trim() === "");
      set(input, "aria-invalid", wrong[field] ? "true" : null);
      const newly = wrong[field] && wrong[field] !== problems[field].textContent;
      say(problems[field], wrong[field]);
      if (newly && app.operating()) requestAnimationFrame(() => problems[field].scrollIntoView({ block: "nearest" }));
    }
    drawKnown(settings.sizes ?? []);
    for (const b of known.querySelectorAll("button")) set(b, "aria-pressed", String(b.dataset.size === settings.size));
  }

  return { root, draw };
}

function createDisplay(app) {
  const status = el("p", { class: "status", "data-state": "display" });
  const shown = SHOWN.map(([kind, label]) => button("show", label, () => app.send({ event: "show", kind }), { "data-kind": kind, class: "small" }));
  const choices = el("div", { class: "choices", role: "group", "aria-label": "What the display shows" }, ...shown);
  const address = el("code", { "data-state": "display-link" });
  const elsewhere = el("details", {}, el("summary", {}, "The projector hangs on another computer"),
    el("p", { class: "hint", "data-state": "display-elsewhere" }, "Open this address there, move the window onto the projector and press F:"),
    el("div", { class: "listing" }, address, copyButton("display-link", "the address of the display page", () => address.textContent)));
  const root = el("section", { class: "part" }, el("h3", {}, "Display window"), status, choices, elsewhere);
  return {
    root,
    draw(state) {
      const { display } = state;
      const m = display.measured;
      const fine = display.connected && !display.problem;
      set(status, "data-value", !display.connected ? "missing" : fine ? "good" : "problem");
      text(status, !display.connected ? "Not open yet. It shows the patterns on the projector."
        : state.demo ? "Open. The simulated projector throws on the sheet what is painted there."
          : !m ? "Open." : `Open, ${pixels(m.viewport)} pixels${m.fullscreen ? ", full screen" : ", not full screen yet"}${fine ? ", pixel for pixel" : ""}.`);
      show(choices, display.connected);
      for (const b of shown) set(b, "aria-pressed", String(display.wanted?.kind === b.dataset.kind));
      text(address, state.links?.display);
      show(elsewhere, Boolean(state.links?.display) && !state.demo);
    },
  };
}

/** The QR code with which a phone gets to its page. */
export function createPhone(app) {
  const image = el("img", { class: "qr", alt: "QR code: the address of the page for the phone" });
  const address = el("code", { "data-state": "camera-link" });
  const listing = el("div", { class: "listing" }, address, copyButton("camera-link", "the address for the phone", () => address.textContent));
  const words = el("p", { class: "hint" });
  const root = el("div", { class: "phone", "data-state": "phone" }, image, el("div", {}, words, listing));
  let drawn = null;
  let visible = null;
  return {
    root,
    draw(state) {
      const phone = state.camera.kind === "phone";
      show(root, phone);
      // Whoever has just chosen the phone wants the code.
      if (phone && visible === false) requestAnimationFrame(() => root.scrollIntoView({ block: "nearest" }));
      visible = phone;
      const links = state.links;
      show(image, Boolean(links?.camera_qr));
      show(listing, Boolean(links?.camera));
      text(words, links?.camera && state.lan ? "Point the phone's camera at the code. Phone and this computer must be in the same network."
        : links ? "The studio listens on this computer only. Start it with --lan, so that the phone can reach it; anyone in that network can then read along."
          : "Who operates the studio sees a code here for the phone.");
      text(address, links?.camera);
      if (links?.camera_qr && links.camera_qr !== drawn) {
        drawn = links.camera_qr;
        URL.revokeObjectURL(image.src);
        // As an image: nothing in it can become part of the page.
        image.src = URL.createObjectURL(new Blob([drawn], { type: "image/svg+xml" }));
      }
    },
  };
}

function createCamera(app) {
  const phone = createPhone(app);
  const which = el("select", { "data-action": "webcam-device", id: "webcam-device" });
  which.addEventListener("change", () => app.startWebcam(which.value));
  const again = button("hold", "Adapt to the light again", () => app.webcam.hold(), { class: "small" });
  const stop = button("stop-webcam", "Stop the webcam", () => app.stopWebcam(), { class: "small" });
  const held = el("p", { class: "hint", "data-state": "held" });
  const devices = el("label", { class: "field", for: "webcam-device" }, el("span", {}, "Camera"), which);
  const webcam = el("div", { class: "webcam" }, devices, held, el("div", { class: "choices" }, again, stop));
  const folder = el("p", { class: "hint", "data-state": "folder" });
  const rows = CAMERAS.map(({ kind, label, about }) => {
    const input = el("input", { type: "radio", name: "camera", value: kind, "data-action": "camera", "data-kind": kind });
    input.addEventListener("change", () => app.chooseCamera(kind));
    return { kind, input, row: el("label", { class: "choice wide" }, input, el("span", {}, label, el("small", {}, about))) };
  });
  const group = el("div", { class: "cameras", role: "radiogroup", "aria-label": "Camera" }, ...rows.map((r) => r.row));
  const root = el("section", { class: "part" }, el("h3", {}, "Camera"), group, webcam, phone.root, folder);

  async function listDevices() {
    const list = await app.webcamList();
    const wanted = list.map((d) => `${d.id}\n${d.name}`).join("\n");
    if (which.dataset.list !== wanted) {
      which.dataset.list = wanted;
      which.replaceChildren(...list.map((d) => el("option", { value: d.id }, d.name)));
    }
    show(devices, list.length > 1);
    if (app.webcam.device) which.value = app.webcam.device;
  }

  return {
    root,
    draw(state) {
      const kind = state.set_up.camera;
      for (const { kind: k, input, row } of rows) {
        input.checked = k === kind;
        // The simulated camera sees the simulated sheet, the others see the real one.
        show(row, (k === "demo") !== state.demo ? false : k === "folder" ? Boolean(state.set_up.watch) || kind === k : true);
      }
      const running = app.here().webcam;
      show(webcam, kind === "webcam" && running);
      if (kind === "webcam" && running) listDevices();
      const names = state.camera.held ?? [];
      text(held, names.length > 0 ? `Held: ${names.join(", ")}.` : "This camera offers no way to hold exposure and focus: switch its automatic focus off where you can.");
      phone.draw(state);
      say(folder, kind === "folder" && state.set_up.watch ? `Photographs are taken from ${state.set_up.watch}.` : "");
      set(root, "data-value", kind);
    },
  };
}

export function createSetUp(app) {
  const settings = createSettings(app);
  const display = createDisplay(app);
  const camera = createCamera(app);
  const introduction = el("p", { class: "hint", "data-state": "introduction" });
  const fields = el("fieldset", { class: "bare" }, introduction, settings.root, camera.root, display.root);
  const root = el("div", { class: "step-panel", "data-state": "panel", "data-step": "set-up" }, fields);
  return {
    root,
    draw(state) {
      fields.disabled = !state.you.operating;
      text(introduction, state.demo ? `${INTRODUCTION} ${IN_DEMO}` : INTRODUCTION);
      settings.draw(state);
      display.draw(state);
      camera.draw(state);
    },
  };
}
