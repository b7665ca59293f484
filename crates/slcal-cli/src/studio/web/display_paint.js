// Paints the panel: plain light, marks at its very corners, or a picture that fits it pixel for pixel.

import { withRole } from "./session.js";

/** Share of the panel's shorter side that an arm of a corner mark takes, and its width. */
const ARM = 0.12;
const ARM_WIDTH = 0.012;

// In two parts: Chromium has been seen to drop a fill of the whole canvas that comes after another one (white after black stayed black).
function plain(c, [w, h], colour) {
  c.fillStyle = colour;
  c.fillRect(0, 0, w, h - 1);
  c.fillRect(0, h - 1, w, 1);
}

function marks(c, [w, h]) {
  plain(c, [w, h], "#000");
  const side = Math.min(w, h);
  const arm = Math.round(side * ARM);
  const width = Math.max(3, Math.round(side * ARM_WIDTH));
  c.fillStyle = "#fff";
  // A frame of one device pixel: overscan swallows it first.
  c.fillRect(0, 0, w, 1);
  c.fillRect(0, h - 1, w, 1);
  c.fillRect(0, 0, 1, h);
  c.fillRect(w - 1, 0, 1, h);
  for (const right of [false, true]) {
    for (const low of [false, true]) {
      c.fillRect(right ? w - arm : 0, low ? h - width : 0, arm, width);
      c.fillRect(right ? w - width : 0, low ? h - arm : 0, width, arm);
    }
  }
}

/** The picture of an address, as it is: no colour management, no scaling. */
export async function fetchPicture(url) {
  const response = await fetch(withRole(url, "display"), { cache: "no-store", credentials: "same-origin" });
  if (!response.ok) throw new Error(`the studio answered with ${response.status}`);
  return createImageBitmap(await response.blob(), { colorSpaceConversion: "none", premultiplyAlpha: "none" });
}

export function paint(canvas, panel, kind, picture = null) {
  // Setting the size clears the canvas even where it is the same.
  if (canvas.width !== panel[0]) canvas.width = panel[0];
  if (canvas.height !== panel[1]) canvas.height = panel[1];
  const c = canvas.getContext("2d", { alpha: false });
  c.imageSmoothingEnabled = false;
  if (picture) c.drawImage(picture, 0, 0);
  else if (kind === "marks") marks(c, panel);
  else plain(c, panel, kind === "white" ? "#fff" : "#000");
  canvas.dataset.value = kind;
}
