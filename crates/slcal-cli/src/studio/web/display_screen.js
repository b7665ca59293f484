// What the display page measures of itself, and what it refuses to show a pattern for.

/** innerWidth is a whole number of CSS pixels: counted from it, a size is off by up to this many device pixels. */
const ROUNDING = 4;

const pixels = ([w, h]) => `${w}x${h}`;
const same = (a, b) => a !== null && a[0] === b[0] && a[1] === b[1];

/** Device pixels of an element, exact where the browser tells them (devicePixelContentBoxSize); null if it does not. */
class DevicePixels {
  size = null;

  constructor(element, onChange) {
    const observer = new ResizeObserver(([entry]) => {
      const box = entry.devicePixelContentBoxSize?.[0];
      this.size = box ? [box.inlineSize, box.blockSize] : null;
      onChange();
    });
    try {
      observer.observe(element, { box: "device-pixel-content-box" });
    } catch {
      observer.observe(element); // Safari: no such box.
    }
  }
}

export class Measure {
  #probe;
  #canvas;

  /** `probe` fills the window, `canvas` is the panel; `onChange()` after every change, also of the zoom and of the screen. */
  constructor(probe, canvas, onChange) {
    this.#probe = new DevicePixels(probe, onChange);
    this.#canvas = new DevicePixels(canvas, onChange);
    addEventListener("resize", onChange);
    document.addEventListener("fullscreenchange", onChange);
    document.addEventListener("visibilitychange", onChange);
    screen.addEventListener?.("change", onChange);
    const watchRatio = () => {
      matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener("change", () => {
        watchRatio();
        onChange();
      }, { once: true });
    };
    watchRatio();
  }

  now() {
    const ratio = devicePixelRatio;
    const counted = [Math.round(innerWidth * ratio), Math.round(innerHeight * ratio)];
    // A scale that developer tools pretend is not in the measured box: then nothing is measured, only counted.
    const measured = this.#probe.size !== null && this.#probe.size.every((n, i) => Math.abs(n - counted[i]) <= ROUNDING);
    const viewport = measured ? this.#probe.size : counted;
    const whole = document.fullscreenElement !== null || matchMedia("(display-mode: fullscreen)").matches;
    const told = [screen.width * ratio, screen.height * ratio];
    // The zoom of the page is in the ratio but, in some browsers, not in the size of the screen. In full screen the width tells it.
    const zoom = whole ? told[0] / viewport[0] : 1;
    const size = told.map((n) => Math.round(n / zoom));
    const canvas = measured ? this.#canvas.size : null;
    return { device_pixel_ratio: ratio, screen: size, viewport, fullscreen: same(viewport, size), whole, canvas };
  }
}

/** Whether the panel comes out at whole device pixels, where the browser does not measure it. */
const dividesEvenly = (panel, ratio) => panel.every((n) => Math.abs((n / ratio) * 64 - Math.round((n / ratio) * 64)) < 1e-6);

const SCALING = "Set the zoom of the browser to 100 % (Ctrl+0) and the scaling of the system to 100 %.";

/** Null where a pattern of `panel` pixels (null: not known yet) is shown pixel for pixel; else what is wrong and what to change. */
export function refusal(panel, measured) {
  const { viewport, fullscreen, whole, device_pixel_ratio: ratio, canvas } = measured;
  if (whole && !fullscreen) {
    return {
      code: "display-not-full-screen",
      message: `Something covers a part of the screen: ${pixels(viewport)} of its ${pixels(measured.screen)} pixels are left.`,
      advice: "Close the bar that the browser shows at the edge of the window, then press F twice.",
    };
  }
  // The window is what measures the projector: only a part that is covered is wrong for any.
  if (!panel) return null;
  if (!fullscreen) {
    const other = !same(measured.screen, panel);
    return {
      code: "display-not-full-screen",
      message: "This window is not full screen, so that a part of the pattern would be missing.",
      advice: `Drag it onto the projector, then press F or double-click.${other ? ` The screen on which it is now has ${pixels(measured.screen)} pixels, the projector ${pixels(panel)}.` : ""}`,
    };
  }
  if (!same(viewport, panel)) {
    const css = [Math.round(viewport[0] / ratio), Math.round(viewport[1] / ratio)];
    if (ratio !== 1 && same(css, panel)) {
      return {
        code: "display-scaled",
        message: `The picture would be scaled: browser and system enlarge it to ${Math.round(100 * ratio)} %, ${pixels(viewport)} pixels for the ${pixels(panel)} of the projector.`,
        advice: `${SCALING} If the projector has ${pixels(viewport)} pixels, say so in Set up.`,
      };
    }
    return {
      code: "display-size",
      message: `This screen has ${pixels(viewport)} pixels, the projector ${pixels(panel)}: the pattern would be scaled or cut.`,
      advice: `Set the resolution of this screen to ${pixels(panel)}, or drag the window onto the right display, or correct the projector's pixels in Set up.${ratio === 1 ? "" : ` ${SCALING}`}`,
    };
  }
  if (canvas ? !same(canvas, panel) : !dividesEvenly(panel, ratio)) {
    return {
      code: "display-scaled",
      message: `The picture would be scaled: at ${Math.round(100 * ratio)} % it takes ${canvas ? pixels(canvas) : "no whole number of"} pixels of the screen instead of ${pixels(panel)}.`,
      advice: SCALING,
    };
  }
  return null;
}
