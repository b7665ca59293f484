// A picture whose keystone is easy to see: circles and squares, with a word that must not lean.

const SIZE = [1200, 848];

export async function testPicture() {
  const [w, h] = SIZE;
  const canvas = new OffscreenCanvas(w, h);
  const c = canvas.getContext("2d", { alpha: false });
  c.fillStyle = "#fff";
  c.fillRect(0, 0, w, h);
  c.strokeStyle = "#0067a3";
  c.lineWidth = 3;
  const cell = w / 12;
  for (let x = 0; x <= w; x += cell) c.strokeRect(x, 0, 0, h);
  for (let y = (h % cell) / 2; y <= h; y += cell) c.strokeRect(0, y, w, 0);
  c.lineWidth = 10;
  c.strokeRect(5, 5, w - 10, h - 10);
  c.strokeStyle = "#b04a00";
  for (const [x, y, r] of [[w / 2, h / 2, 3 * cell], [cell * 1.5, cell * 1.5, cell], [w - cell * 1.5, cell * 1.5, cell],
    [cell * 1.5, h - cell * 1.5, cell], [w - cell * 1.5, h - cell * 1.5, cell]]) {
    c.beginPath();
    c.arc(x, y, r, 0, 2 * Math.PI);
    c.stroke();
  }
  c.fillStyle = "#1b1f24";
  c.font = `600 ${Math.round(cell * 1.4)}px system-ui, sans-serif`;
  c.textAlign = "center";
  c.textBaseline = "middle";
  c.fillText("slcal", w / 2, h / 2);
  return canvas.convertToBlob({ type: "image/png" });
}
