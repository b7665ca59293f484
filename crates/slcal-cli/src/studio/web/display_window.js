// Opens the display page in a window of its own, on the projector where the browser can tell which screen that is.

import { Problem } from "./session.js";
import { pixels } from "./words.js";

const NAME = "slcal-display";
/** The simulated projector needs no screen: a small window that leaves this page in view. */
const DEMO_SIZE = [460, 420];

const BLOCKED = new Problem({
  code: "display-blocked",
  message: "The browser did not open the display window.",
  advice: "Press the button once more, or allow this page to open windows (sign in the address bar).",
});

/** The screen that has the projector's size; else one that is not this window's; else null. */
function projectorOf(details, panel) {
  const others = details.screens.filter((s) => s !== details.currentScreen);
  const fits = (s) => panel && Math.round(s.width * s.devicePixelRatio) === panel[0] && Math.round(s.height * s.devicePixelRatio) === panel[1];
  return others.find(fits) ?? others[0] ?? null;
}

/** Asks for the screens only where there are several: the question would be of no use otherwise. */
async function secondScreen(panel) {
  if (!window.getScreenDetails || !screen.isExtended) return null;
  try {
    return projectorOf(await window.getScreenDetails(), panel);
  } catch {
    return null; // Not allowed: the window is dragged there by hand.
  }
}

export class DisplayWindow {
  #window = null;

  get open() {
    return this.#window !== null && !this.#window.closed;
  }

  /** Must be called from a click. Returns what to tell, or null. */
  async show({ link, panel, demo }) {
    if (this.open) {
      this.#window.focus();
      return null;
    }
    const target = demo ? null : await secondScreen(panel);
    let features = "popup";
    if (target) {
      features += `,left=${target.availLeft},top=${target.availTop},width=${target.availWidth},height=${target.availHeight}`;
    } else if (demo) {
      const [w, h] = DEMO_SIZE;
      features += `,width=${w},height=${h},left=${screen.availLeft + screen.availWidth - w},top=${screen.availTop + screen.availHeight - h}`;
    } else {
      features += ",width=960,height=640";
    }
    // This page's own address: a cookie belongs to the host under which it was given.
    const token = link ? new URL(link, location.origin).hash : "";
    this.#window = window.open(`/display${token}`, NAME, features);
    if (!this.#window) throw BLOCKED;
    if (demo) return null;
    if (target) return `The display window is on ${target.label || `the screen of ${pixels([target.width, target.height])}`}: click into it and press F.`;
    return "Drag the display window onto the projector, click into it and press F.";
  }
}
