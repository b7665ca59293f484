// Live frames of the webcam: small ones for the overlay, one at a time; whole ones for a continuous scan, of which the next is under way
// while one is reconstructed.

/** Longer side, unless the studio asks for another. */
const LONGER_SIDE = 1280;
const QUALITY = 0.8;
const SHORTEST_MS = 60;
const SHORTEST_WHOLE_MS = 25;
/** A frame whose answer was lost must not stop the picture for ever. */
const PATIENCE_MS = 1000;

export class Frames {
  #video;
  #socket;
  #seq = 0;
  #timer = null;
  #sent = 0;
  #underWay = new Set();
  #canvas = new OffscreenCanvas(1, 1);
  /** 0: as large as they are. */
  longest = LONGER_SIDE;

  constructor(video, socket) {
    this.#video = video;
    this.#socket = socket;
  }

  start() {
    if (this.#timer === null) this.#send();
  }

  stop() {
    clearTimeout(this.#timer);
    this.#timer = null;
    this.#underWay.clear();
  }

  /** The studio looked at a frame. */
  answered(seq) {
    if (this.#timer === null) return;
    // One that was overtaken is not answered any more.
    for (const sent of this.#underWay) if (sent <= seq) this.#underWay.delete(sent);
    this.#soon();
  }

  get #whole() {
    return this.longest === 0;
  }

  /** The next frame, as soon as it may go. */
  #soon() {
    if (this.#underWay.size >= (this.#whole ? 2 : 1)) return;
    clearTimeout(this.#timer);
    const pause = this.#whole ? SHORTEST_WHOLE_MS : SHORTEST_MS;
    this.#timer = setTimeout(() => this.#send(), Math.max(0, this.#sent + pause - performance.now()));
  }

  async #send() {
    const { videoWidth: w, videoHeight: h } = this.#video;
    this.#timer = setTimeout(() => {
      this.#underWay.clear();
      this.#send();
    }, PATIENCE_MS);
    if (!w || !this.#socket.up) return;
    const mine = ++this.#seq;
    this.#underWay.add(mine);
    this.#sent = performance.now();
    const scale = this.longest > 0 ? Math.min(1, this.longest / Math.max(w, h)) : 1;
    const [cw, ch] = [Math.round(w * scale), Math.round(h * scale)];
    if (this.#canvas.width !== cw || this.#canvas.height !== ch) [this.#canvas.width, this.#canvas.height] = [cw, ch];
    this.#canvas.getContext("2d", { alpha: false }).drawImage(this.#video, 0, 0, cw, ch);
    const jpeg = await this.#canvas.convertToBlob({ type: "image/jpeg", quality: QUALITY });
    const head = new DataView(new ArrayBuffer(8));
    head.setUint32(0, mine, true);
    this.#socket.sendBinary(new Blob([head.buffer, jpeg]));
    if (this.#timer !== null) this.#soon();
  }
}
