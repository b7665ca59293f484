// Photographs as files: dropped anywhere on the page, or chosen.

import { el } from "./dom.js";
import { Problem } from "./session.js";
import { refusal, sendPhotograph, sendPicture } from "./upload.js";

export function createDrop(app) {
  // Opened by buttons that say what they are for: by themselves they are neither seen, nor reached, nor read out.
  const unseen = { type: "file", class: "out-of-sight", tabindex: "-1", "aria-hidden": "true" };
  const files = el("input", { ...unseen, accept: "image/*,.tif,.tiff,.webp,.bmp", multiple: true, "data-action": "files" });
  const picture = el("input", { ...unseen, accept: "image/*", "data-action": "picture-file" });
  const veil = el("div", { class: "veil", hidden: true, "data-state": "drop" }, el("p"));

  async function send(list, kind) {
    // What was wrong with files of before is of no interest any more.
    app.forget("file-");
    const post = { picture: sendPicture, photograph: sendPhotograph }[kind];
    // One after the other: the order of the photographs stays, and a slow network is not choked.
    for (const file of list) {
      const refused = refusal(file, kind);
      const key = `file-${file.name}`;
      if (refused) {
        app.problem(key, refused);
        continue;
      }
      try {
        await post(app.role, file, file.name, { page: app.state.you.page });
        app.problem(key, null);
      } catch ({ code, message, advice }) {
        app.problem(key, new Problem({ code, message: `“${file.name}”: ${message}`, advice }));
      }
    }
  }
  const take = (list) => send(list, app.state?.step === "use" ? "picture" : "photograph");

  files.addEventListener("change", async () => {
    const chosen = [...files.files];
    files.value = ""; // The same file may be chosen again.
    await take(chosen);
  });
  picture.addEventListener("change", async () => {
    const chosen = [...picture.files];
    picture.value = "";
    await send(chosen, "picture");
  });

  // dragenter and dragleave come for every element that is crossed.
  let depth = 0;
  const hasFiles = (event) => event.dataTransfer?.types.includes("Files");
  const veiled = (on) => {
    if (!on) depth = 0;
    veil.hidden = !on;
    veil.firstChild.textContent = !app.operating() ? "Only who operates the studio can add photographs."
      : app.state?.step === "use" ? "Drop the picture to project" : "Drop the photographs";
  };
  addEventListener("dragenter", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    depth++;
    veiled(true);
  });
  addEventListener("dragover", (event) => hasFiles(event) && event.preventDefault());
  addEventListener("dragleave", (event) => {
    if (hasFiles(event) && --depth <= 0) veiled(false);
  });
  addEventListener("drop", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    veiled(false);
    if (app.operating()) take([...event.dataTransfer.files]);
  });

  return { nodes: [files, picture, veil], choose: () => files.click(), choosePicture: () => picture.click() };
}
