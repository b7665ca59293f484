// What was found, drawn over the picture: the sheet, the corners, and the outline where the sheet should come.

import { el, set, show, svg, text } from "./dom.js";

const points = (quad) => quad.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ");
const middle = (quad) => [0, 1].map((i) => quad.reduce((sum, p) => sum + p[i], 0) / quad.length);
/** Arrows shorter than this share of the picture's width would only be clutter. */
const SHORTEST_ARROW = 0.02;

/** From here on the sheet is where it should be: the photograph is taken. */
export const NEAR = 0.55;
const NEARING = 0.25;

/** Nearness in words that style and text follow; null where nothing is wanted. */
export function nearness(near) {
  if (typeof near !== "number") return null;
  return near >= NEAR ? "reached" : near >= NEARING ? "nearing" : "far";
}

/** More words than these would cover the picture. */
const LONGEST_WORDS = 90;

/** The ghost's corners in the order that is nearest to the sheet's: which corner is called the first does not matter. */
function paired(from, to) {
  const length = (shift) => from.reduce((sum, p, i) => {
    const q = to[(i + shift) % to.length];
    return sum + Math.hypot(p[0] - q[0], p[1] - q[1]);
  }, 0);
  const best = [0, 1, 2, 3].reduce((a, b) => (length(b) < length(a) ? b : a));
  return from.map((p, i) => [p, to[(i + best) % to.length]]);
}

export function createOverlay() {
  const sheet = svg("polygon", { class: "sheet", "data-state": "sheet" });
  const ghost = svg("polygon", { class: "ghost", "data-state": "ghost" });
  const corners = svg("path", { class: "corners", "data-state": "corners" });
  const arrows = svg("path", { class: "arrows" });
  const drawing = svg("svg", { class: "overlay", "aria-hidden": "true", preserveAspectRatio: "none" }, ghost, sheet, corners, arrows);
  const words = el("p", { class: "ghost-words", "data-state": "ghost-words" });
  show(words, false);

  /** Beside the outline, where there is more room: they must hide neither the corners nor what these should reach. */
  function place(quad, [w, h]) {
    const ys = quad.map((p) => p[1]);
    const [high, low] = [Math.min(...ys) / h, Math.max(...ys) / h];
    const below = 1 - low >= high;
    words.style.left = `${(100 * Math.min(0.6, Math.max(0.4, middle(quad)[0] / w))).toFixed(1)}%`;
    words.style.top = below ? `${(100 * Math.min(0.82, low + 0.015)).toFixed(1)}%` : "";
    words.style.bottom = below ? "" : `${(100 * Math.min(0.82, 1 - high + 0.015)).toFixed(1)}%`;
  }

  return {
    drawing,
    words,
    /** `found`: {size, sheet, corners, near}; `guide` as in the state, or null. */
    draw(found, guide) {
      const size = found?.size ?? guide?.size;
      if (!size) {
        for (const part of [sheet, ghost, corners, arrows]) set(part, "d", null), set(part, "points", null);
        show(words, false);
        return;
      }
      const [w, h] = size;
      // Whole numbers are the centres of pixels.
      set(drawing, "viewBox", `-0.5 -0.5 ${w} ${h}`);
      set(sheet, "points", found?.sheet ? points(found.sheet) : null);
      const r = w / 320;
      set(corners, "d", (found?.corners ?? []).map(([x, y]) =>
        `M${(x - r).toFixed(1)} ${y.toFixed(1)}h${(2 * r).toFixed(1)}M${x.toFixed(1)} ${(y - r).toFixed(1)}v${(2 * r).toFixed(1)}`).join(""));
      set(corners, "data-count", found?.corners?.length ?? 0);

      const [sx, sy] = guide ? [w / guide.size[0], h / guide.size[1]] : [1, 1];
      const quad = guide?.quad?.map(([x, y]) => [(x + 0.5) * sx - 0.5, (y + 0.5) * sy - 0.5]);
      set(ghost, "points", quad ? points(quad) : null);
      set(ghost, "data-near", nearness(found?.near));
      // A pose that is only offered, not asked for, stays in the background.
      const asked = Boolean(quad && guide.needed);
      set(ghost, "data-needed", asked);
      const pairs = asked && found?.sheet ? paired(found.sheet, quad) : [];
      set(arrows, "d", pairs.filter(([p, q]) => Math.hypot(p[0] - q[0], p[1] - q[1]) > SHORTEST_ARROW * w)
        .map(([p, q]) => arrow(p, q, w / 80)).join(""));

      const said = !asked ? "" : guide.words.length <= LONGEST_WORDS ? guide.words : "Bring the sheet here";
      show(words, Boolean(said));
      text(words, said);
      if (asked) place(quad, size);
    },
  };
}

function arrow([x0, y0], [x1, y1], head) {
  const angle = Math.atan2(y1 - y0, x1 - x0);
  const barb = (turn) => `${(x1 - head * Math.cos(angle + turn)).toFixed(1)} ${(y1 - head * Math.sin(angle + turn)).toFixed(1)}`;
  return `M${x0.toFixed(1)} ${y0.toFixed(1)}L${x1.toFixed(1)} ${y1.toFixed(1)}M${barb(0.45)}L${x1.toFixed(1)} ${y1.toFixed(1)}L${barb(-0.45)}`;
}
