// The point cloud that turns. The newest cloud comes by itself; the view has its own controls.

import { el, say, set, show, text } from "./dom.js";
import { withRole } from "./session.js";
import { thousands } from "./words.js";

export function createCloud(app) {
  const container = el("div", { class: "cloud-place" });
  const words = el("p", { class: "placeholder" }, "The point cloud appears here.");
  const figures = el("p", { class: "cloud-figures", "data-state": "cloud-figures" });
  const root = el("section", { class: "cloud", "aria-label": "Point cloud" }, container, words, figures);

  let view = null;
  let failed = false; // for good: without WebGL nothing can be drawn
  let tries = 0;
  let wanted = null;
  let shown = null;
  let loading = false;

  // Only when there is a cloud: a page that never scans needs no graphics card.
  async function viewer() {
    if (view || failed) return view;
    // Browsers may remember that a module did not come: its address is another one each time.
    const { CloudView } = await import(`/web/cloud_view.js${tries++ > 0 ? `?try=${tries}` : ""}`);
    try {
      view = new CloudView(container, { label: "Point cloud" });
    } catch (error) {
      failed = true;
      show(container, false);
      show(words, true);
      text(words, `The cloud cannot be drawn here (${error.message}). It is saved all the same: open its PLY or GLB in MeshLab, CloudCompare or Blender.`);
    }
    return view;
  }

  async function load(url) {
    wanted = url;
    if (loading) return;
    loading = true;
    while (wanted && wanted !== shown) {
      const now = wanted;
      try {
        const response = await fetch(withRole(now, app.role), { credentials: "same-origin" });
        // A live cloud may have been overtaken by the next one.
        if (response.ok) {
          const data = await response.arrayBuffer();
          (await viewer())?.setCloud(data);
        }
        shown = now;
      } catch {
        // The connection is lost; the state that comes after it asks for the cloud again.
        if (wanted === now) wanted = null;
      }
    }
    loading = false;
  }

  return {
    root,
    draw(state, picked) {
      const { live, clouds, continuous, fps } = state.scan;
      const now = live ?? clouds.find((c) => c.id === picked) ?? clouds.at(-1);
      show(words, !now || failed);
      show(container, Boolean(now) && !failed);
      const points = now ? `${thousands(now.points)} points` : "";
      say(figures, live ? `${points}, ${fps.toFixed(1)} clouds per second` : now ? `${now.name}, ${points}` : "");
      set(figures, "data-points", now?.points);
      set(figures, "data-value", continuous ? "live" : now ? "still" : "none");
      // Made again with another rig, it is another cloud.
      if (now) load(now.rig ? `${now.url}?rig=${now.rig}` : now.url);
    },
  };
}
