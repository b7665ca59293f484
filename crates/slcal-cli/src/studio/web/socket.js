// The one connection over which states come and events go. It comes back by itself.

import { stillIn } from "./session.js";

const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 8000;

export class Socket {
  #role;
  #listeners;
  #ws = null;
  #wait = FIRST_WAIT_MS;

  /**
   * `listeners` has a function per type of message (state, live, shoot, refused), and `link({up, retryMs, ended})`
   * for the connection itself.
   */
  constructor(role, listeners) {
    this.#role = role;
    this.#listeners = listeners;
    this.#open();
  }

  get up() {
    return this.#ws?.readyState === WebSocket.OPEN;
  }

  send(event) {
    if (this.up) this.#ws.send(JSON.stringify(event));
    return this.up;
  }

  sendBinary(data) {
    if (this.up) this.#ws.send(data);
    return this.up;
  }

  #open() {
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const ws = new WebSocket(`${scheme}//${location.host}/ws?as=${this.#role}`);
    this.#ws = ws;
    ws.addEventListener("open", () => {
      this.#wait = FIRST_WAIT_MS;
      this.#listeners.link?.({ up: true });
    });
    ws.addEventListener("message", ({ data }) => {
      const message = JSON.parse(data);
      // Types that a later server adds are not an error.
      this.#listeners[message.type]?.(message);
    });
    ws.addEventListener("close", () => this.#again());
  }

  #again() {
    const wait = this.#wait;
    this.#wait = Math.min(LONGEST_WAIT_MS, wait * 2);
    this.#listeners.link?.({ up: false, retryMs: wait });
    setTimeout(async () => {
      // A server that was started anew does not know this page any more: trying on would be in vain.
      if ((await stillIn(this.#role)) === false) this.#listeners.link?.({ up: false, ended: true });
      else this.#open();
    }, wait);
  }
}
