// Draws the plots after the page is shown: unpacks numbers, inserts the page's colours, draws one plot after the other.
(() => {
  "use strict";
  const figures = JSON.parse(document.getElementById("figures").textContent);
  const root = document.documentElement;
  const settings = { responsive: true, displayModeBar: false, displaylogo: false, doubleClick: "reset" };

  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const unpack = {
    u16: (p) => {
      const codes = new Uint16Array(bytes(p.data).buffer);
      return Float32Array.from(codes, (c) => (c === 65535 ? NaN : p.low + p.step * c));
    },
    index16: (p) => new Uint16Array(bytes(p.data).buffer),
    index32: (p) => new Uint32Array(bytes(p.data).buffer),
    rgb: (p) => {
      const all = bytes(p.data);
      const colours = new Array(all.length / 3);
      for (let i = 0; i < colours.length; i++) {
        colours[i] = `rgb(${all[3 * i]},${all[3 * i + 1]},${all[3 * i + 2]})`;
      }
      return colours;
    },
  };

  // "$name" becomes the page's colour of that name, packed numbers become arrays.
  const ready = (x, colour) => {
    if (typeof x === "string") return x[0] === "$" ? colour(x.slice(1)) : x;
    if (Array.isArray(x)) return typeof x[0] === "number" ? x : x.map((y) => ready(y, colour));
    if (x === null || typeof x !== "object") return x;
    if (x.packed) return (x.unpacked ??= unpack[x.packed](x));
    return Object.fromEntries(Object.entries(x).map(([k, v]) => [k, ready(v, colour)]));
  };
  const colours = () => {
    const style = getComputedStyle(root);
    return (name) => style.getPropertyValue("--" + name).trim();
  };
  // A change applies to all of its traces, unless it is a list with one value each; plotly expects a list.
  const listed = (change) =>
    Object.fromEntries(Object.entries(change).map(([k, v]) =>
      [k, k === "visible" && Array.isArray(v) ? v : Array.isArray(v) || ArrayBuffer.isView(v) ? [v] : v]));

  const drawn = new Map();
  const choose = (figure, index) => {
    const div = document.getElementById(figure.id);
    const choice = figure.choices[index];
    figure.chosen = index;
    for (const button of document.querySelectorAll(`[data-for="${figure.id}"] button`)) {
      button.setAttribute("aria-pressed", String(button.dataset.choice === String(index)));
    }
    return Plotly.restyle(div, listed(ready(choice.change, colours())), choice.traces);
  };
  // 3D plots rotate with the arrow keys as with the mouse; + and - zoom.
  const AXES = ["x", "y", "z"];
  const TURN = Math.PI / 18;
  const HIGHEST = (80 * Math.PI) / 180;
  const NEARER = 0.85;
  const dot = (a, b) => a.x * b.x + a.y * b.y + a.z * b.z;
  const cross = (a, b) => ({ x: a.y * b.z - a.z * b.y, y: a.z * b.x - a.x * b.z, z: a.x * b.y - a.y * b.x });
  const times = (a, s) => ({ x: a.x * s, y: a.y * s, z: a.z * s });
  const unit = (a) => times(a, 1 / (Math.hypot(a.x, a.y, a.z) || 1));
  const turned = (v, axis, angle) => {
    const [side, along, c, s] = [cross(axis, v), dot(axis, v), Math.cos(angle), Math.sin(angle)];
    return Object.fromEntries(AXES.map((k) => [k, v[k] * c + side[k] * s + axis[k] * along * (1 - c)]));
  };
  const steered = ({ eye, up }, key) => {
    const pole = unit(up);
    // From one height to another, short of the pole.
    const climbed = (by) => {
      const height = Math.asin(Math.max(-1, Math.min(1, dot(unit(eye), pole))));
      const wanted = Math.max(-HIGHEST, Math.min(HIGHEST, height + by));
      return turned(eye, unit(cross(pole, eye)), height - wanted);
    };
    switch (key) {
      case "ArrowLeft": return turned(eye, pole, TURN);
      case "ArrowRight": return turned(eye, pole, -TURN);
      case "ArrowUp": return climbed(TURN);
      case "ArrowDown": return climbed(-TURN);
      case "+": case "=": return times(eye, NEARER);
      case "-": return times(eye, 1 / NEARER);
      default: return null;
    }
  };
  const steer = (div) => {
    div.tabIndex = 0;
    div.addEventListener("keydown", (event) => {
      const eye = event.ctrlKey || event.altKey || event.metaKey ? null : steered(div._fullLayout.scene.camera, event.key);
      if (!eye) return;
      event.preventDefault();
      Plotly.relayout(div, { "scene.camera.eye": eye });
    });
  };
  const draw = async (figure) => {
    const div = document.getElementById(figure.id);
    const colour = colours();
    const layout = ready(figure.layout, colour);
    if (figure.space) {
      // A narrow window shows the scene from farther away.
      const away = Math.max(1, 720 / Math.max(div.clientWidth, 200)) ** 0.8;
      const eye = layout.scene.camera.eye;
      for (const axis of AXES) eye[axis] *= away;
      steer(div);
    }
    await Plotly.newPlot(div, ready(figure.data, colour), layout, settings);
    drawn.set(figure.id, div);
    const choices = document.querySelector(`[data-for="${figure.id}"]`);
    if (choices) {
      choices.hidden = false;
      choices.addEventListener("click", (event) => {
        const button = event.target.closest("button");
        if (button) choose(figure, Number(button.dataset.choice));
      });
    }
  };
  const recolour = () => {
    for (const figure of figures) {
      const div = drawn.get(figure.id);
      if (!div) continue;
      const layout = ready(figure.layout, colours());
      // Keep the reader's view.
      if (figure.space) layout.scene.camera = div._fullLayout.scene.camera;
      Plotly.react(div, ready(figure.data, colours()), layout, settings);
      if (figure.chosen) choose(figure, figure.chosen);
    }
  };
  // Paper is light and narrow, and canvases are not redrawn for it: 3D plots are printed as pictures.
  const PAPER_PX = 660;
  const printed = () => {
    root.classList.add("on-paper");
    for (const figure of figures) {
      const div = drawn.get(figure.id);
      if (!div) continue;
      const layout = ready(figure.layout, colours());
      if (!figure.space) {
        Object.assign(layout, { width: Math.min(div.clientWidth, PAPER_PX), height: 270, autosize: false });
        Plotly.react(div, ready(figure.data, colours()), layout, { ...settings, responsive: false });
        if (figure.chosen) choose(figure, figure.chosen);
        continue;
      }
      layout.scene.camera = div._fullLayout.scene.camera;
      Plotly.react(div, ready(figure.data, colours()), layout, settings);
      if (figure.chosen) choose(figure, figure.chosen);
      const canvas = div.querySelector(".gl-container canvas, canvas");
      if (!canvas) continue;
      const scene = div._fullLayout.scene._scene;
      scene.glplot.redraw();
      const picture = new Image();
      picture.className = "printed";
      picture.alt = "";
      picture.src = canvas.toDataURL("image/png");
      div.prepend(picture);
    }
  };
  const unprinted = () => {
    root.classList.remove("on-paper");
    for (const picture of document.querySelectorAll(".printed")) picture.remove();
    recolour();
  };
  const pause = () => new Promise((next) => requestAnimationFrame(() => setTimeout(next)));
  // The library is large: show the page before loading it.
  const load = () => {
    const library = document.createElement("script");
    library.textContent = document.getElementById("plotly").textContent;
    document.head.append(library);
  };
  const seen = (figure) => {
    const { top, bottom } = document.getElementById(figure.id).getBoundingClientRect();
    return bottom > 0 && top < innerHeight;
  };

  const all = async () => {
    await pause();
    load();
    // Flat plots first, as 3D plots take longest; but plots in view come before all others.
    const left = [...figures].sort((a, b) => a.space - b.space);
    while (left.length) {
      const [figure] = left.splice(Math.max(0, left.findIndex(seen)), 1);
      performance.mark(figure.id);
      await draw(figure);
      performance.measure(`draw ${figure.id}`, figure.id);
      await pause();
    }
    root.dataset.drawn = "all";
    performance.mark("drawn");
  };

  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
  addEventListener("beforeprint", printed);
  addEventListener("afterprint", unprinted);
  for (const listing of document.querySelectorAll(".listing")) {
    const button = listing.querySelector(".copy");
    if (!navigator.clipboard) continue;
    button.hidden = false;
    button.addEventListener("click", async () => {
      try {
        await navigator.clipboard.writeText(listing.querySelector("code").textContent);
      } catch {
        // Not allowed here: the reader selects the words, which stay where they are.
        return;
      }
      button.textContent = "Copied";
      setTimeout(() => (button.textContent = "Copy"), 2000);
    });
  }
  all();
})();
