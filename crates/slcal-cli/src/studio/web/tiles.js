// The photographs as tiles: what was found in each, how well it fits, and the button that throws it out.

import { button, el, keyed, set, say, show, svg, text } from "./dom.js";
import { withRole } from "./session.js";
import { degrees, sentence } from "./words.js";

const TILE_WIDTH = 320;
const FIGURES = "rms: how far the corners lie, in the mean, from where the calibration expects them. " +
  "Tilt: about the horizontal and about the vertical axis.";

function words(photo) {
  if (photo.problem) return sentence(photo.problem.message);
  const parts = [];
  if (photo.of) parts.push(photo.corners === photo.of ? `${photo.of} corners` : `${photo.corners} of ${photo.of} corners`);
  if (typeof photo.rms_px === "number") parts.push(`rms ${photo.rms_px.toFixed(3)} px`);
  if (photo.tilt_deg) parts.push(`tilt ${photo.tilt_deg.map(degrees).join(", ")}`);
  return parts.join(" · ");
}

export function createTiles(app) {
  const list = el("ul", { class: "tiles" });
  const drawAll = keyed(list, (photo) => photo.id, ({ id }) => {
    const image = el("img", { alt: "", loading: "lazy" });
    const outline = svg("polygon");
    const drawing = svg("svg", { "aria-hidden": "true", preserveAspectRatio: "none" }, outline);
    const look = button("look", "", () => app.look(id), { class: "look", "data-id": id });
    look.append(image, drawing);
    const name = el("p", { class: "file" });
    const figures = el("p", { class: "figures", title: FIGURES });
    const advice = el("p", { class: "advice" });
    const toggle = button("photograph", "", () => {
      const now = app.state.photographs.find((p) => p.id === id);
      app.send({ event: "photograph", id, used: !now.used });
    }, { class: "small", "data-id": id });
    const root = el("li", { class: "tile", "data-state": "photograph", "data-id": id }, look,
      el("div", { class: "about" }, name, figures, advice, toggle));
    return {
      root,
      draw(photo) {
        const url = withRole(photo.url, app.role, { width: TILE_WIDTH });
        if (image.dataset.url !== url) {
          image.dataset.url = url;
          image.src = url;
        }
        if (photo.size) set(drawing, "viewBox", `-0.5 -0.5 ${photo.size[0]} ${photo.size[1]}`);
        set(outline, "points", photo.outline ? photo.outline.map((p) => p.join(",")).join(" ") : null);
        set(look, "aria-label", `Look at ${photo.name}`);
        set(look, "aria-pressed", String(app.looking() === photo.id));
        set(root, "data-value", photo.problem ? "refused" : photo.used ? "used" : "out");
        text(name, photo.name);
        text(figures, photo.used || photo.problem ? words(photo) : `thrown out · ${words(photo)}`);
        say(advice, sentence(photo.problem?.advice));
        show(toggle, !(photo.problem && !photo.used));
        text(toggle, photo.used ? "Throw out" : "Use again");
        set(toggle, "aria-label", `${toggle.textContent}: ${photo.name}`);
        toggle.disabled = !app.operating();
      },
    };
  });
  const title = el("h3", {}, "Photographs");
  const root = el("section", { class: "part" }, title, list);
  return {
    root,
    draw(state) {
      show(root, state.photographs.length > 0);
      // The newest first: the one that was just taken is the one to look at.
      drawAll([...state.photographs].reverse());
    },
  };
}
