// Sending photographs as they are, with a limit that is told before anything is sent.

import { Problem, problemOf, withRole } from "./session.js";
import { bytes } from "./words.js";

const LARGEST = 50 * 1024 * 1024;

/** Before a file is sent: null, or why it is not. */
export function refusal(file) {
  if (file.size > LARGEST) {
    return new Problem({
      code: "too-large",
      message: `“${file.name}” has ${bytes(file.size)}; a photograph may have up to 50 MB.`,
      advice: "Save it as JPEG or PNG, at full size. A folder given by --watch takes larger files.",
    });
  }
  if (file.size === 0) {
    return new Problem({ code: "empty", message: `“${file.name}” is empty.`, advice: "Copy it from the camera again." });
  }
  // A name that says nothing (phones) is left to the server, which looks into the file.
  if (file.type && !file.type.startsWith("image/") && file.type !== "application/octet-stream") {
    return new Problem({
      code: "no-picture",
      message: `“${file.name}” is no picture (${file.type}).`,
      advice: "Choose a photograph: JPEG, PNG, TIFF, WebP or BMP.",
    });
  }
  return null;
}

async function post(path, role, body, more) {
  let response;
  try {
    response = await fetch(withRole(path, role, more), { method: "POST", body, credentials: "same-origin" });
  } catch {
    throw new Problem({
      code: "upload-broken",
      message: "The photograph did not arrive.",
      advice: "See that this device and the studio are still in the same network, then send it again.",
    });
  }
  if (!response.ok) throw await problemOf(response);
  return response.json().catch(() => ({}));
}

/** `{id}` of the photograph, or a Problem. `more` has the `page` that sends it and the `shot` that it answers. */
export const sendPhotograph = (role, body, name, more = {}) => post("/api/photographs", role, body, { name, ...more });

/** The picture that is projected onto the sheet. */
export const sendPicture = (role, body, name, more = {}) => post("/api/picture", role, body, { name, ...more });
