// The camera's picture with what was found: the webcam of this computer, frames that the studio serves, or a photograph.

import { button, el, say, set, show, text } from "./dom.js";
import { createOverlay, nearness } from "./overlay.js";
import { withRole } from "./session.js";
import { degrees, pixels, thousands, told } from "./words.js";

const EMPTY = {
  webcam: "The webcam is not running yet.",
  phone: "Photographs of the phone appear here.",
  folder: "Photographs that the camera saves into the folder appear here.",
  files: "Drop photographs anywhere on this page.",
  demo: "The simulated camera sees the sheet as soon as the display window is open.",
};

export function createPicture(app, video) {
  const canvas = el("canvas", { role: "img", "aria-label": "Picture of the camera" });
  const still = el("img", { alt: "" });
  const overlay = createOverlay();
  const placeholder = el("p", { class: "placeholder", "data-state": "placeholder" });
  const caption = el("p", { class: "caption", "data-state": "picture-problem", role: "status" });
  const back = button("live-picture", "Back to the live picture", () => {
    const id = chosen;
    const focused = document.activeElement === back;
    photograph(null);
    if (focused) returned(id);
  }, { class: "small back" });
  const frame = el("div", { class: "frame", "data-state": "picture" }, video, canvas, still, overlay.drawing, overlay.words, caption, back);
  const stage = el("div", { class: "stage" }, frame, placeholder);
  const readings = Object.fromEntries(["size", "corners", "sharpness", "clipped", "tilt", "near"].map((name) =>
    [name, el("li", { "data-state": name })]));
  const root = el("section", { class: "picture", "aria-label": "Camera" }, stage,
    el("ul", { class: "readings" }, ...Object.values(readings)));

  still.addEventListener("load", () => draw());
  still.addEventListener("error", () => {
    broken = true;
    draw();
  });

  let chosen = null; // id of the photograph that is looked at instead of the live picture
  let served = null; // the last live frame that was drawn, with what was found in it
  let waiting = null; // the newest one that came while another was loading
  let loading = false;
  let broken = false; // the photograph could not be loaded

  const source = (state) => {
    const known = state.photographs.find((p) => p.id === chosen);
    if (known) return { kind: "photograph", photo: known };
    if (app.here().webcam) return { kind: "webcam" };
    if (served) return { kind: "served" };
    const last = state.photographs.at(-1);
    if (last) return { kind: "photograph", photo: last };
    return { kind: state.step === "calibrate" && state.guide ? "guide" : "none" };
  };

  function draw() {
    const state = app.state;
    if (!state) return;
    const { kind, photo } = source(state);
    const live = kind === "webcam" ? app.live : kind === "served" ? served : null;
    set(frame, "data-value", kind);
    show(video, kind === "webcam");
    show(canvas, kind === "served");
    show(frame, kind !== "none");
    show(placeholder, kind === "none");
    show(back, Boolean(chosen) && kind === "photograph");
    text(placeholder, EMPTY[state.camera.kind] ?? "No camera yet: choose one in Set up.");
    let found = live && { ...live, near: app.near(live) };
    if (kind === "photograph") {
      const url = withRole(photo.url, app.role);
      if (still.dataset.url !== url) {
        broken = false;
        still.dataset.url = url;
        still.src = url;
        set(still, "alt", `Photograph ${photo.name}`);
      }
      const natural = still.naturalWidth ? [still.naturalWidth, still.naturalHeight] : null;
      found = { size: photo.size ?? natural, sheet: photo.outline, corners: [], near: null };
    }
    show(still, kind === "photograph" && !broken);
    const size = kind === "webcam" && video.videoWidth ? [video.videoWidth, video.videoHeight] : found?.size ?? (kind === "guide" ? state.guide.size : [4, 3]);
    frame.style.setProperty("--ratio", String(size[0] / size[1]));
    // Over a photograph that somebody looks at it would only hide what was found there.
    const guide = state.step === "calibrate" && (kind !== "photograph" || photo.id !== chosen) ? state.guide : null;
    overlay.draw(found, guide);
    const problem = kind === "photograph" ? photo.problem : live?.problem;
    say(caption, told(problem) || (kind === "photograph" && broken ? `${photo.name} cannot be loaded now.` : ""));
    set(caption, "data-value", problem?.code);

    const full = state.camera.size && kind !== "photograph" ? state.camera.size : size;
    say(readings.size, kind === "none" || kind === "guide" ? "" : `${pixels(full)} px`);
    const corners = live?.corners?.length ?? (kind === "photograph" ? photo.corners : 0);
    // A photograph that is refused as it is was not searched.
    const looked = kind === "photograph" ? !photo.problem || corners || photo.outline : state.step === "calibrate" || live?.stripes;
    const seen = live?.stripes ? `${thousands(live.stripes)} stripe points` : corners ? `${corners} corners` : found?.sheet ? "sheet seen" : "no sheet";
    say(readings.corners, kind === "none" || kind === "guide" || !looked ? "" : seen);
    set(readings.corners, "data-value", corners || live?.stripes ? "good" : found?.sheet ? "fair" : "weak");
    say(readings.sharpness, typeof live?.sharpness === "number" ? `sharpness ${(100 * live.sharpness).toFixed(0)} %` : "");
    say(readings.clipped, live?.clipped_percent > 0 ? `${live.clipped_percent.toFixed(1)} % clipped` : "");
    const tilt = live?.tilt_deg ?? (kind === "photograph" ? photo.tilt_deg : null);
    say(readings.tilt, tilt ? `tilt ${tilt.map(degrees).join(", ")}` : "");
    const near = guide?.needed ? nearness(found?.near) : null;
    say(readings.near, { far: "away from the dashed outline", nearing: "nearly there", reached: live?.problem ? "on the dashed outline" : "there: hold it still" }[near]);
    set(readings.near, "data-value", near === "reached" ? "good" : near === "nearing" ? "fair" : null);
  }

  async function load(live) {
    waiting = live;
    if (loading) return;
    loading = true;
    // Latest wins: frames that came while one was loading are passed over.
    while (waiting) {
      const now = waiting;
      waiting = null;
      const kind = app.state.camera.kind;
      const image = new Image();
      image.src = withRole(now.url, app.role);
      try {
        await image.decode();
      } catch {
        continue; // The studio has a newer one already.
      }
      if (app.state.camera.kind !== kind) continue; // Of the camera before.
      if (canvas.width !== image.naturalWidth || canvas.height !== image.naturalHeight) {
        [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
      }
      canvas.getContext("2d").drawImage(image, 0, 0);
      served = now; // Drawn together with the picture in which it was found.
      draw();
    }
    loading = false;
  }

  function photograph(id) {
    chosen = id;
    draw();
    app.redraw();
  }

  /** The button is gone: the focus returns to the photograph that was looked at, or to the picture. */
  function returned(id) {
    const look = document.querySelector(`[data-action=look][data-id="${id}"]`);
    const to = [look, frame].find((node) => node?.checkVisibility() && node.tabIndex >= 0);
    if (to) to.focus({ preventScroll: true });
    else app.focus();
  }

  let kindBefore = null;
  return {
    root,
    frame,
    draw(state) {
      if (kindBefore !== null && kindBefore !== state.camera.kind) served = null;
      kindBefore = state.camera.kind;
      // The studio is there: it may have the photograph now.
      if (broken) delete still.dataset.url;
      draw();
    },
    live(live) {
      // The webcam of this page is the live picture itself; where it was taken away, the studio still has an old frame.
      if (app.here().webcam || !live.url || (app.operating() && app.state.camera.kind === "webcam")) draw();
      else load(live);
    },
    photograph,
    /** The camera is gone: its last picture would look like a live one. */
    forget() {
      served = null;
    },
    get chosen() {
      return chosen;
    },
  };
}
