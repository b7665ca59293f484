// The webcam of this computer: its largest picture, with exposure, focus and white balance held where it offers that.

import { Problem } from "./session.js";

/** More than any webcam has: the browser then takes the largest that there is. */
const LARGEST = { width: { ideal: 7680 }, height: { ideal: 4320 } };
/** The automatic exposure has found its value by then. */
const SETTLE_MS = 2000;
/** Larger pictures are sent as JPEG: as PNG they would take seconds. */
const PNG_PIXELS = 4e6;
const QUALITY = 0.95;
const HOLDS = [
  { mode: "exposureMode", value: "exposureTime", name: "exposure" },
  { mode: "focusMode", value: "focusDistance", name: "focus" },
  { mode: "whiteBalanceMode", value: "colorTemperature", name: "white balance" },
];

const wait = (ms) => new Promise((done) => setTimeout(done, ms));

function explained(error) {
  const told = {
    NotAllowedError: ["camera-refused", "The browser does not allow this page to use the camera.",
      "Press the camera sign in the address bar, allow the camera, then start the webcam again."],
    NotFoundError: ["camera-missing", "This computer has no camera that the browser can see.",
      "Plug one in and start the webcam again, or choose phone, folder or files."],
    NotReadableError: ["camera-busy", "The camera cannot be opened: another program uses it.",
      "Close that program (a video call, another tab), then start the webcam again."],
    OverconstrainedError: ["camera-missing", "The camera that was chosen is not there any more.", "Choose another one."],
  }[error.name];
  const [code, message, advice] = told ?? ["camera-failed", `The camera cannot be opened: ${error.message}.`,
    "Unplug it and plug it in again, or choose phone, folder or files."];
  return new Problem({ code, message, advice });
}

const INSECURE = new Problem({
  code: "camera-insecure",
  message: "The browser gives a camera only to pages of its own computer, and this page comes from another one.",
  advice: "Open the studio on the computer that has the camera, by its 127.0.0.1 address; or take the photographs with the phone.",
});

export class Webcam {
  #video;
  #stream = null;
  #onChange;
  #onLost;
  held = [];

  /** `onChange()` when size or held settings changed, `onLost(problem)` when the camera went away by itself. */
  constructor(video, { onChange, onLost }) {
    this.#video = video;
    this.#onChange = onChange;
    this.#onLost = onLost;
    video.muted = true;
    video.playsInline = true;
    video.addEventListener("resize", () => this.running && this.#onChange());
  }

  get running() {
    return this.#stream !== null && this.#video.videoWidth > 0;
  }

  get size() {
    return this.running ? [this.#video.videoWidth, this.#video.videoHeight] : null;
  }

  get device() {
    return this.#stream?.getVideoTracks()[0]?.getSettings().deviceId ?? null;
  }

  /** Cameras by name; the names are there once one was allowed. */
  static async list() {
    const devices = (await navigator.mediaDevices?.enumerateDevices?.()) ?? [];
    return devices.filter((d) => d.kind === "videoinput").map((d, i) => ({ id: d.deviceId, name: d.label || `Camera ${i + 1}` }));
  }

  /** Whether the camera may be started without asking. */
  static async allowed() {
    try {
      return (await navigator.permissions.query({ name: "camera" })).state === "granted";
    } catch {
      return false;
    }
  }

  async start(device = null) {
    if (!navigator.mediaDevices?.getUserMedia) throw INSECURE;
    this.stop();
    let stream;
    try {
      stream = await navigator.mediaDevices.getUserMedia({
        audio: false,
        video: device ? { ...LARGEST, deviceId: { exact: device } } : { ...LARGEST, facingMode: "environment" },
      });
    } catch (error) {
      throw explained(error);
    }
    this.#stream = stream;
    stream.getVideoTracks()[0].addEventListener("ended", () => {
      if (this.#stream !== stream) return;
      this.stop();
      this.#onLost(new Problem({
        code: "camera-lost",
        message: "The camera was taken away.",
        advice: "Plug it in again and start the webcam. Leave it where it was: a camera that moved needs a new calibration.",
      }));
    });
    this.#video.srcObject = stream;
    await this.#video.play().catch(() => {});
    if (!this.#video.videoWidth) await new Promise((done) => this.#video.addEventListener("loadedmetadata", done, { once: true }));
    this.#onChange();
    this.hold();
  }

  stop() {
    this.#stream?.getTracks().forEach((track) => track.stop());
    this.#stream = null;
    this.#video.srcObject = null;
    this.held = [];
  }

  /** Lets the camera adapt to the light, then holds what it found. */
  async hold() {
    const stream = this.#stream;
    const track = stream?.getVideoTracks()[0];
    const offered = track?.getCapabilities?.() ?? {};
    const usable = HOLDS.filter(({ mode }) => offered[mode]?.includes("manual"));
    this.held = [];
    for (const { mode } of usable) {
      if (offered[mode].includes("continuous")) await track.applyConstraints({ advanced: [{ [mode]: "continuous" }] }).catch(() => {});
    }
    if (usable.length > 0) await wait(SETTLE_MS);
    if (this.#stream !== stream) return;
    for (const { mode, value, name } of usable) {
      const now = track.getSettings()[value];
      const wanted = now === undefined ? { [mode]: "manual" } : { [mode]: "manual", [value]: now };
      // One by one: a camera that refuses one of them may still hold the others.
      const done = await track.applyConstraints({ advanced: [wanted] }).then(() => true, () => false);
      if (done && track.getSettings()[mode] === "manual") this.held.push(name);
    }
    if (this.#stream === stream) this.#onChange();
  }

  /**
   * The picture at full size, as a file. From the video and not by ImageCapture.takePhoto, whose photographs may have another
   * size and another field of view than the live picture.
   */
  async grab() {
    const video = this.#video;
    const canvas = new OffscreenCanvas(video.videoWidth, video.videoHeight);
    canvas.getContext("2d", { alpha: false }).drawImage(video, 0, 0);
    const png = canvas.width * canvas.height <= PNG_PIXELS;
    const blob = await canvas.convertToBlob(png ? { type: "image/png" } : { type: "image/jpeg", quality: QUALITY });
    return { blob, name: png ? "webcam.png" : "webcam.jpg" };
  }
}
