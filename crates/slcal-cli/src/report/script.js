// Starts the view of what is in space, and the buttons that copy commands. Flat plots need no script.
(async () => {
  const root = document.documentElement;
  const carried = (id) => document.getElementById(id);
  /** What an element carries as base64 of a zlib stream. */
  const unpacked = (id) => {
    const text = atob(carried(id).textContent);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
  };
  const showCloud = async (view) => {
    const [cloud, noise] = await Promise.all([unpacked("cloud"), unpacked("noise")]);
    view.setCloud(cloud, { values: { noise: { text: "noise", unit: "mm", values: new Float32Array(noise) } } });
  };

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

  // The page is there to read before what is in space is drawn.
  await new Promise((next) => requestAnimationFrame(() => setTimeout(next)));
  const space = carried("space");
  if (!space) return;
  const choices = ["photograph", "depth", "sigma"];
  const view = new CloudView(space, { label: space.dataset.label, choices, whole: "whole" in space.dataset });
  view.setScene(JSON.parse(carried("scene").textContent));
  if (carried("cloud")) {
    await showCloud(view).catch((error) => {
      carried("not-unpacked").hidden = false;
      console.error(error);
    });
  }
  requestAnimationFrame(() => {
    root.dataset.drawn = "all";
    performance.mark("drawn");
  });
})();
