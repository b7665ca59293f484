// Sending photographs as they are, with a limit that is told before anything is sent.

import { Problem, problemOf, withRole } from "./session.js";
import { bytes } from "./words.js";

const LARGEST = 50 * 1024 * 1024;

/** What is sent, and what to do where it cannot be. A photograph is measured and must stay as it is; a picture is only shown. */
const KINDS = {
  photograph: {
    tooLarge: "Save it as JPEG or PNG, at full size. A folder given by --watch takes larger files.",
    empty: "Copy it from the camera again.",
    other: "Choose a photograph: JPEG, PNG, TIFF, WebP or BMP.",
  },
  picture: {
    tooLarge: "Save it smaller: the projector has only a few million pixels.",
    empty: "Choose another picture, or save this one again.",
    other: "Choose a picture to project: JPEG, PNG, TIFF, WebP or BMP.",
  },
};

/** Before a file is sent as a "photograph" or as a "picture": null, or why it is not. */
export function refusal(file, kind) {
  if (file.size > LARGEST) {
    return new Problem({
      code: "too-large",
      message: `“${file.name}” has ${bytes(file.size)}; a ${kind} may have up to 50 MB.`,
      advice: KINDS[kind].tooLarge,
    });
  }
  if (file.size === 0) {
    return new Problem({ code: "empty", message: `“${file.name}” is empty.`, advice: KINDS[kind].empty });
  }
  // A name that says nothing (phones) is left to the server, which looks into the file.
  if (file.type && !file.type.startsWith("image/") && file.type !== "application/octet-stream") {
    return new Problem({
      code: "no-picture",
      message: `“${file.name}” is no picture (${file.type}).`,
      advice: KINDS[kind].other,
    });
  }
  return null;
}

async function post(path, kind, role, body, more) {
  let response;
  try {
    response = await fetch(withRole(path, role, more), { method: "POST", body, credentials: "same-origin" });
  } catch {
    throw new Problem({
      code: "upload-broken",
      message: `The ${kind} did not arrive.`,
      advice: "See that this device and the studio are still in the same network, then send it again.",
    });
  }
  if (!response.ok) throw await problemOf(response);
  return response.json().catch(() => ({}));
}

/** `{id}` of the photograph, or a Problem. `more` has the `page` that sends it and the `shot` that it answers. */
export const sendPhotograph = (role, body, name, more = {}) => post("/api/photographs", "photograph", role, body, { name, ...more });

/** The picture that is projected onto the sheet. */
export const sendPicture = (role, body, name, more = {}) => post("/api/picture", "picture", role, body, { name, ...more });
