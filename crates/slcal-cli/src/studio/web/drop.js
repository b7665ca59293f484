// Photographs as files: dropped anywhere on the page, or chosen.

import { el } from "./dom.js";
import { Problem } from "./session.js";
import { refusal, sendPhotograph, sendPicture } from "./upload.js";

export function createDrop(app) {
  const files = el("input", { type: "file", accept: "image/*,.tif,.tiff,.webp,.bmp", multiple: true, class: "out-of-sight", tabindex: "-1",
    "data-action": "files", "aria-label": "Photographs" });
  const picture = el("input", { type: "file", accept: "image/*", class: "out-of-sight", tabindex: "-1",
    "data-action": "picture-file", "aria-label": "Picture to project" });
  const veil = el("div", { class: "veil", hidden: true, "data-state": "drop" }, el("p"));

  async function send(list, post) {
    // One after the other: the order of the photographs stays, and a slow network is not choked.
    for (const file of list) {
      const refused = refusal(file);
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
  const take = (list) => send(list, app.state?.step === "use" ? sendPicture : sendPhotograph);

  files.addEventListener("change", async () => {
    const chosen = [...files.files];
    files.value = ""; // The same file may be chosen again.
    await take(chosen);
  });
  picture.addEventListener("change", async () => {
    const chosen = [...picture.files];
    picture.value = "";
    await send(chosen, sendPicture);
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
