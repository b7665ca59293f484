// A point cloud, its surface, and the devices and sheets around it, turned by mouse, finger and keys in WebGL 2.
//
//   const view = new CloudView(document.getElementById("cloud"), { label: "Points of scan-001.ply" });
//   view.setCloud(await (await fetch("/api/clouds/1")).arrayBuffer());
//
// Coordinates are those of the files: the camera's frame, x right, y down, z away from the camera, in mm. Styles are in
// cloud_view.css; colours are the page's variables --paper, --ink, --muted, --line, --cloud, --surface and those that a
// scene names. Nothing is loaded, and nothing is drawn unless something changed.

const DEGREE = Math.PI / 180;
/** Vertical field of view: long enough a lens that parallel lines stay nearly parallel. */
const TAN_HALF_VIEW = Math.tan(14 * DEGREE);
/** From where the view begins, degrees to the left and above: on a cloud, and on a whole scene with its devices. */
const BEGIN = { cloud: { left: 25, above: 14 }, all: { left: 50, above: 21 } };
const KEY_TURN = 10 * DEGREE;
const KEY_ZOOM = 0.85;
/** Share of the view's height by which a key pans. */
const KEY_PAN = 0.1;
const DRAG_TURN = 0.4 * DEGREE;
/** A press that moves less than this, CSS px, is a click; two of them within the time a double click. */
const CLICK_PX = 5;
const DOUBLE_CLICK_MS = 400;
const PICK_PX = 10;
/** A frame that takes longer is drawn with coarse edges as long as the view moves, and finely once it has been still. */
const SLOW_MS = 50;
const REST_MS = 250;
/** More pixels than this per CSS pixel cost time and are not seen. */
const MAX_PIXEL_RATIO = 2;
/** Quantiles are taken of about this many values: the colours' range moves by less than a shade. */
const SAMPLE = 8192;
/** Share of values beyond either end of the colours, so that a few far ones do not make the rest alike. */
const TAIL = 0.02;
/** Stands for "unknown" where the graphics card reads values; NaN is not dependable there. */
const UNKNOWN = 3e38;
const HEADER_BYTES = 16;
const POINT_BYTES = 20;
const TRIANGLE_BYTES = 12;
/** Below this width, CSS px, the view is laid out for a phone. */
const NARROW_PX = 560;
/** The box that is seen where there is nothing to see. */
const NOTHING = { low: [-100, -100, 900], high: [100, 100, 1100] };
const AXES = ["x right, mm", "y down, mm", "z depth, mm"];

/** The cloud's name in the legend. */
const POINTS = "points";

const COLOURINGS = {
  photograph: { text: "photograph" },
  depth: { text: "depth", unit: "mm" },
  sigma: { text: "σ", unit: "mm" },
  plain: { text: "plain" },
};
const HELP =
  "Drag or press the arrow keys to turn. Drag with shift or the right button, move two fingers, or press shift and an arrow " +
  "key to move. Scroll, pinch or press + and − to zoom. Double-click a point to turn about it. Double-click beside the points, " +
  "or press 0 or Home, to reset. The point at the pointer is given in mm. Dark photographs are shown brighter than they are. " +
  "The scale bar holds at the depth of the turning point. Names in the legend hide what they name.";

// ---- Reading a cloud

const malformed = (expected, found) => new Error(`malformed cloud: expected ${expected}, found ${found}`);

/**
 * Reads a cloud: "SLCV", u32 1, u32 n, u32 m, f32 xyz[3n], f32 sigma[n], u8 rgba[4n], u32 triangles[3m], little endian.
 * Throws where anything is not as it has to be.
 */
function readCloud(buffer) {
  const kind = Object.prototype.toString.call(buffer).slice(8, -1);
  if (kind !== "ArrayBuffer") throw malformed("an ArrayBuffer", kind);
  const bytes = buffer.byteLength;
  if (bytes < HEADER_BYTES) throw malformed(`at least ${HEADER_BYTES} bytes`, bytes);
  const header = new DataView(buffer);
  const magic = String.fromCharCode(...new Uint8Array(buffer, 0, 4));
  if (magic !== "SLCV") throw malformed('"SLCV" at its start', JSON.stringify(magic));
  const [version, n, m] = [4, 8, 12].map((at) => header.getUint32(at, true));
  if (version !== 1) throw malformed("version 1", version);
  const length = HEADER_BYTES + POINT_BYTES * n + TRIANGLE_BYTES * m;
  if (bytes !== length) throw malformed(`${length} bytes for ${n} points and ${m} triangles`, bytes);

  const places = new Float32Array(buffer, HEADER_BYTES, 3 * n);
  const sigma = new Float32Array(buffer, HEADER_BYTES + 12 * n, n);
  const photo = new Uint8Array(buffer, HEADER_BYTES + 16 * n, 4 * n);
  const triangles = new Uint32Array(buffer, HEADER_BYTES + POINT_BYTES * n, 3 * m);
  // Differences of numbers that are not finite are not 0.
  for (let i = 0; i < places.length; i++) {
    if (places[i] - places[i] === 0) continue;
    throw malformed("finite coordinates", `${places[i]} as ${"xyz"[i % 3]} of point ${Math.floor(i / 3)}`);
  }
  for (let i = 0; i < n; i++) {
    if (sigma[i] < 0 || sigma[i] === Infinity) throw malformed("σ of zero or more, or NaN", `${sigma[i]} at point ${i}`);
  }
  for (let i = 0; i < triangles.length; i++) {
    if (triangles[i] >= n) throw malformed(`corners below ${n}`, `${triangles[i]} in triangle ${Math.floor(i / 3)}`);
  }
  return { n, m, places, sigma, photo, triangles };
}

/** What is derived from a cloud once: its box, its middle, places about the middle, the distance between points. */
function prepared(cloud, values) {
  const { n, places, sigma, photo } = cloud;
  const box = usualBox(places);
  const middle = box.low.map((low, k) => (low + box.high[k]) / 2);
  const local = new Float32Array(3 * n);
  const depth = new Float32Array(n);
  // Loops over all points are plain: what is short elsewhere costs milliseconds here.
  const middleX = middle[0], middleY = middle[1], middleZ = middle[2];
  let reach = 0;
  for (let i = 0, k = 0; i < n; i++, k += 3) {
    const x = places[k] - middleX, y = places[k + 1] - middleY, z = places[k + 2] - middleZ;
    local[k] = x;
    local[k + 1] = y;
    local[k + 2] = z;
    depth[i] = places[k + 2];
    const square = x * x + y * y + z * z;
    if (square > reach) reach = square;
  }
  const measured = {
    depth: { ...COLOURINGS.depth, values: depth },
    sigma: { ...COLOURINGS.sigma, values: sigma },
    ...values,
  };
  const offers = { photograph: isColourful(photo), plain: true };
  for (const [name, one] of Object.entries(measured)) {
    one.range = colourRange(one.values);
    offers[name] = one.range !== null;
  }
  return {
    ...cloud, box, middle, local, measured, offers, reach: Math.sqrt(reach), spacing: spacing(places), gain: gain(photo), normals: null,
  };
}

/** Values beyond the format, one per point: `{noise: {text, unit, values}}`. */
function checkedValues(values, n) {
  return Object.fromEntries(Object.entries(values).map(([name, given]) => {
    const all = Float32Array.from(given.values);
    if (all.length !== n) throw malformed(`${n} values of ${name}`, all.length);
    if (all.some((x) => Math.abs(x) === Infinity)) throw malformed(`finite values of ${name}, or NaN`, "an infinite one");
    return [name, { text: name, ...given, values: all }];
  }));
}

/** The box of all points, or of nearly all where a few are far away from the rest. */
function usualBox(places) {
  const box = { low: [], high: [] };
  for (let k = 0; k < 3 && places.length; k++) {
    let low = Infinity, high = -Infinity;
    for (let i = k; i < places.length; i += 3) {
      const x = places[i];
      if (x < low) low = x;
      if (x > high) high = x;
    }
    const [usualLow, usualHigh] = quantiles(places, TAIL, k, 3);
    const room = usualHigh - usualLow;
    box.low[k] = low < usualLow - room ? usualLow : low;
    box.high[k] = high > usualHigh + room ? usualHigh : high;
  }
  return places.length ? box : { low: [0, 0, 0], high: [0, 0, 0] };
}

/** Lower and upper quantile of the finite values at `first`, `first + step`, ...; null where there are none. */
function quantiles(values, tail, first = 0, step = 1) {
  const stride = step * Math.max(1, Math.floor(values.length / step / SAMPLE));
  const sample = new Float32Array(Math.ceil(Math.max(0, values.length - first) / stride));
  let count = 0;
  for (let i = first; i < values.length; i += stride) if (Number.isFinite(values[i])) sample[count++] = values[i];
  if (!count) return null;
  const sorted = sample.subarray(0, count).sort();
  const at = (share) => sorted[Math.round(share * (count - 1))];
  return [at(tail), at(1 - tail)];
}

/** What the colours span: nearly all values; null where there are none. Values that are all alike get some room. */
function colourRange(values) {
  const range = quantiles(values, TAIL);
  if (!range || range[0] < range[1]) return range;
  const room = Math.max(Math.abs(range[0]) * 1e-3, 1e-3);
  return [range[0] - room, range[1] + room];
}

/** About how far apart points are, mm: their share of the part of the camera's image that they fill, at their median depth. */
function spacing(places) {
  const total = places.length / 3;
  const stride = Math.max(1, Math.floor(total / SAMPLE));
  const count = Math.ceil(total / stride);
  if (count < 2) return 1;
  const u = new Float32Array(count), v = new Float32Array(count);
  for (let i = 0, k = 0; i < count; i++, k += 3 * stride) {
    const z = Math.max(Math.abs(places[k + 2]), 1e-3);
    u[i] = places[k] / z;
    v[i] = places[k + 1] / z;
  }
  const [[left, right], [top, bottom]] = [quantiles(u, TAIL), quantiles(v, TAIL)];
  // So coarse that a part that is filled has some points in each cell.
  const cells = Math.max(4, Math.floor(Math.sqrt(count) / 3));
  const perColumn = cells / (right - left), perRow = cells / (bottom - top);
  const filled = new Uint8Array(cells * cells);
  for (let i = 0; i < count; i++) {
    const column = Math.floor((u[i] - left) * perColumn), row = Math.floor((v[i] - top) * perRow);
    if (column >= 0 && column < cells && row >= 0 && row < cells) filled[row * cells + column] = 1;
  }
  const share = filled.reduce((sum, x) => sum + x, 0) / cells ** 2;
  const area = share * (right - left) * (bottom - top);
  return Math.abs(quantiles(places, 0.5, 2, 3)[0]) * Math.sqrt(area / total) || 1;
}

/** By how much the photograph's colours are brightened: photographs of stripes are taken in dark rooms. */
function gain(photo) {
  const stride = 4 * Math.max(1, Math.floor(photo.length / 4 / SAMPLE));
  const brightest = new Float32Array(Math.ceil(photo.length / stride));
  for (let i = 0, k = 0; k < photo.length; i++, k += stride) {
    brightest[i] = photo[k + 3] ? Math.max(photo[k], photo[k + 1], photo[k + 2]) : NaN;
  }
  const [, bright] = quantiles(brightest, 0.05) ?? [0, 255];
  return Math.max(1, Math.min(3, 230 / Math.max(bright, 1)));
}

function isColourful(photo) {
  for (let i = 4; i < photo.length; i += 4) {
    if (photo[i + 3] && (photo[i] !== photo[0] || photo[i + 1] !== photo[1] || photo[i + 2] !== photo[2])) return true;
  }
  return photo.length === 4 && photo[3] > 0;
}

/** A normal per point: the mean of its triangles' normals, weighted by their areas. */
function normals({ local, triangles }) {
  const sums = new Float32Array(local.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = local[b] - local[a], uy = local[b + 1] - local[a + 1], uz = local[b + 2] - local[a + 2];
    const vx = local[c] - local[a], vy = local[c + 1] - local[a + 1], vz = local[c + 2] - local[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    sums[a] += x, sums[a + 1] += y, sums[a + 2] += z;
    sums[b] += x, sums[b + 1] += y, sums[b + 2] += z;
    sums[c] += x, sums[c + 1] += y, sums[c + 2] += z;
  }
  for (let i = 0; i < sums.length; i += 3) {
    const length = Math.sqrt(sums[i] ** 2 + sums[i + 1] ** 2 + sums[i + 2] ** 2) || 1;
    sums[i] /= length;
    sums[i + 1] /= length;
    sums[i + 2] /= length;
  }
  return sums;
}

// ---- Numbers

/** The 1, 2 or 5 times a power of ten that is at least `x`. */
function niceStep(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return power * ([1, 2, 5, 10].find((k) => k * power >= x * 0.999) ?? 10);
}

/** Round numbers between two others. */
function ticks(low, high, step) {
  const all = [];
  for (let i = Math.ceil(low / step - 1e-6); i * step <= high + 1e-6 * step; i++) all.push(i * step);
  return all;
}

/** A number with as many decimals as tell it from another that is `step` away. */
function numeral(x, step) {
  const text = x.toFixed(Math.min(6, Math.max(0, -Math.floor(Math.log10(step) + 1e-9))));
  return /[1-9]/.test(text) ? text.replace("-", "−") : text.replace("-", "");
}

// ---- Vectors

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, b, by = 1) => [a[0] + b[0] * by, a[1] + b[1] * by, a[2] + b[2] * by];
const between = (a, b, share) => a.map((x, k) => x + (b[k] - x) * share);
const cornersOf = ({ low, high }) => [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((k) => (i & (1 << k) ? high : low)[k]));
/** The smallest box about points. */
function boxOf(points) {
  const of = (pick) => [0, 1, 2].map((k) => points.reduce((x, p) => pick(x, p[k]), points[0][k]));
  return { low: of(Math.min), high: of(Math.max) };
}

// ---- The viewer

/** Where the scene is seen from: about a turning point, upright, as on a turntable. */
class Viewer {
  pivot = [0, 0, 1000];
  yaw = 0;
  pitch = 0;
  distance = 1000;
  /** Size of the view, CSS px. */
  width = 1;
  height = 1;

  /** Pixels per mm at a depth of 1 mm. */
  get focal() {
    return this.height / 2 / TAN_HALF_VIEW;
  }

  /** The directions right, down and forward of the view. */
  get directions() {
    const { yaw, pitch } = this;
    const right = [Math.cos(yaw), 0, -Math.sin(yaw)];
    const forward = [Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch), Math.cos(yaw) * Math.cos(pitch)];
    return { right, down: cross(forward, right), forward };
  }

  get eye() {
    return plus(this.pivot, this.directions.forward, -this.distance);
  }

  /** Turns the scene as a finger on its front would. */
  turn(right, down) {
    this.yaw = Math.atan2(Math.sin(this.yaw + right), Math.cos(this.yaw + right));
    this.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.pitch + down));
  }

  /** Moves the scene by CSS px at the depth of the turning point. */
  pan(right, down) {
    const perPixel = this.distance / this.focal;
    const axes = this.directions;
    this.pivot = plus(plus(this.pivot, axes.right, -right * perPixel), axes.down, -down * perPixel);
  }

  /** Nearer (below 1) or farther away from a point, which stays where it is on the screen. */
  zoom(factor, about, [nearest, farthest]) {
    const by = Math.max(nearest, Math.min(farthest, this.distance * factor)) / this.distance;
    this.pivot = between(about, this.pivot, by);
    this.distance *= by;
  }

  /** The point under a place of the screen at the depth of the turning point. */
  under(x, y) {
    const perPixel = this.distance / this.focal;
    const axes = this.directions;
    return plus(plus(this.pivot, axes.right, (x - this.width / 2) * perPixel), axes.down, (y - this.height / 2) * perPixel);
  }

  /** Looks at points from a side, as near as all of them fit within the margins (CSS px) of the view. */
  fit(points, { left, above }, margins) {
    this.yaw = left * DEGREE;
    this.pitch = above * DEGREE;
    if (!points.length) return;
    const box = boxOf(points);
    this.pivot = between(box.low, box.high, 0.5);
    const axes = this.directions;
    const tanX = Math.max(this.width / 2 - margins[0], this.width / 4) / this.focal;
    const tanY = Math.max(this.height / 2 - margins[1], this.height / 4) / this.focal;
    // What is near looks larger, so the middle of the picture is not that of the box: move, and come nearer.
    for (let round = 0; round < 4; round++) {
      const seen = points.map((p) => plus(p, this.pivot, -1)).map((d) => [axes.right, axes.down, axes.forward].map((axis) => dot(d, axis)));
      this.distance = Math.max(1e-3, ...seen.map(([x, y, z]) => Math.max(Math.abs(x) / tanX, Math.abs(y) / tanY) - z));
      const middle = (all) => (Math.min(...all) + Math.max(...all)) / 2;
      const [x, y] = [0, 1].map((k) => middle(seen.map((p) => (p[k] / (p[2] + this.distance)) * this.distance)));
      if (round < 3) this.pivot = plus(plus(this.pivot, axes.right, x), axes.down, y);
    }
  }

  /** A function that gives the place on the screen, CSS px, and the depth of points. */
  projection() {
    const { eye, focal, width, height, directions: { right, down, forward } } = this;
    return (p) => {
      const d = plus(p, eye, -1);
      const depth = dot(d, forward);
      return { x: width / 2 + (focal * dot(d, right)) / depth, y: height / 2 + (focal * dot(d, down)) / depth, depth };
    };
  }

  /** From coordinates about an origin to those of WebGL: right, up, towards the viewer. */
  matrix(origin) {
    const { right, down, forward } = this.directions;
    const rows = [right, down.map((x) => -x), forward.map((x) => -x)];
    const shift = plus(origin, this.eye, -1);
    const columns = [0, 1, 2].flatMap((k) => [...rows.map((row) => row[k]), 0]);
    return new Float32Array([...columns, ...rows.map((row) => dot(row, shift)), 1]);
  }

  perspective(near, far) {
    const y = 1 / TAN_HALF_VIEW;
    const x = (y * this.height) / this.width;
    return new Float32Array([
      x, 0, 0, 0, 0, y, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0,
    ]);
  }
}

// ---- Colours

/**
 * Colours from low to high: lightness grows evenly while the hue goes from violet over blue and green to yellow (in OKLCH), so
 * that equal steps look equal, in grey and to eyes that do not tell red from green as well. Both ends stand out from the paper.
 */
function colourMap(dark) {
  const [first, last] = dark ? [0.42, 0.95] : [0.28, 0.86];
  const map = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; i++) {
    const share = i / 255;
    map.set([...fromOklch(first + (last - first) * share, 0.15, (300 - 195 * share) * DEGREE), 255], 4 * i);
  }
  return map;
}

/** sRGB, 0 to 255; the chroma is lowered to what sRGB has. */
function fromOklch(lightness, chroma, hue) {
  const [a, b] = [chroma * Math.cos(hue), chroma * Math.sin(hue)];
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const linear = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  if (chroma > 0.01 && linear.some((x) => x < -1e-4 || x > 1.0001)) return fromOklch(lightness, chroma * 0.97, hue);
  return linear.map((x) => {
    const light = Math.max(0, Math.min(1, x));
    return Math.round(255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055));
  });
}

/** Colours of style sheets as numbers: lets the browser resolve variables and read what they say. */
class Palette {
  #probe = document.createElement("span");
  #dot = document.createElement("canvas").getContext("2d", { willReadFrequently: true });

  constructor(root) {
    this.#probe.hidden = true;
    root.append(this.#probe);
  }

  /** As the browser writes it, for the 2D canvas. */
  css(colour) {
    this.#probe.style.color = "";
    this.#probe.style.color = colour;
    return getComputedStyle(this.#probe).color;
  }

  /** Red, green and blue from 0 to 1. */
  rgb(colour) {
    this.#dot.clearRect(0, 0, 1, 1);
    this.#dot.fillStyle = this.css(colour);
    this.#dot.fillRect(0, 0, 1, 1);
    return [...this.#dot.getImageData(0, 0, 1, 1).data].slice(0, 3).map((x) => x / 255);
  }
}

// ---- Drawing with WebGL

const CLOUD_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 photo;
layout(location = 3) in float value;
uniform mat4 view, projection;
uniform float pointSize;
uniform vec2 pointLimits;
uniform int colouring;
uniform vec2 range;
uniform float gain;
uniform vec3 plain, unknown;
uniform sampler2D map;
out vec3 tint, towards, seen;
out float size;
void main() {
  vec4 at = view * vec4(place, 1.0);
  seen = at.xyz;
  towards = mat3(view) * normal;
  gl_Position = projection * at;
  size = clamp(pointSize / max(-at.z, 1e-6), pointLimits.x, pointLimits.y);
  gl_PointSize = size;
  float share = clamp((value - range.x) / (range.y - range.x), 0.0, 1.0);
  tint = plain;
  if (colouring == 0) tint = photo.a > 0.5 ? min(photo.rgb * gain, 1.0) : unknown;
  if (colouring == 1) tint = value > 1e38 ? unknown : textureLod(map, vec2((share * 255.0 + 0.5) / 256.0, 0.5), 0.0).rgb;
}`;

const CLOUD_FRAGMENT = `#version 300 es
precision highp float;
in vec3 tint, towards, seen;
in float size;
uniform bool points, coverage;
uniform float light;
uniform vec3 paper;
uniform vec3 haze;
out vec4 shown;
const vec3 LAMP = normalize(vec3(-0.45, 0.55, 0.75));
void main() {
  // Where a corner has no normal, that of the triangle.
  vec3 flatNormal = cross(dFdx(seen), dFdy(seen));
  bool known = dot(towards, towards) > 0.01;
  vec3 normal = known ? towards : flatNormal;
  float shade = 1.0;
  if (known || !points) {
    normal = normalize(normal);
    // Both sides are lit.
    if (dot(normal, seen) > 0.0) normal = -normal;
    float facing = 0.5 + 0.5 * dot(normal, LAMP);
    shade = mix(1.0, 0.18 + 0.92 * facing * facing, light);
  }
  float alpha = 1.0;
  if (points) {
    float radius = length(gl_PointCoord * 2.0 - 1.0);
    alpha = coverage ? clamp((1.0 - radius) * size * 0.5 + 0.5, 0.0, 1.0) : 1.0;
    if (radius > 1.0 + (coverage ? 1.0 / size : 0.0)) discard;
    // Large points have a darker rim, so that neighbours stay apart.
    shade *= 1.0 - 0.3 * smoothstep(4.0, 10.0, size) * radius * radius;
  }
  float far = smoothstep(haze.x, haze.y, -seen.z) * haze.z;
  shown = vec4(mix(min(tint * shade, 1.0), paper, far), alpha);
}`;

// A line is as wide as it is told, which those of WebGL are not: two triangles that face the viewer.
const LINE_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec3 colour;
uniform mat4 view, projection;
uniform vec2 viewport;
uniform float width, near;
out vec4 tint;
void main() {
  vec3 a = (view * vec4(from, 1.0)).xyz, b = (view * vec4(to, 1.0)).xyz;
  tint = vec4(colour, 1.0);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (a.z > -near && b.z > -near) return;
  if (a.z > -near) a = mix(b, a, (-near - b.z) / (a.z - b.z));
  if (b.z > -near) b = mix(a, b, (-near - a.z) / (b.z - a.z));
  vec4 start = projection * vec4(a, 1.0), end = projection * vec4(b, 1.0);
  vec2 along = (end.xy / end.w - start.xy / start.w) * viewport;
  along = length(along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);
  bool last = gl_VertexID > 1;
  vec4 at = last ? end : start;
  vec2 side = vec2(-along.y, along.x) * (gl_VertexID % 2 == 0 ? 1.0 : -1.0);
  at.xy += (side + along * (last ? 0.5 : -0.5)) * width / viewport * at.w;
  gl_Position = at;
}`;

const FACE_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 colour;
uniform mat4 view, projection;
out vec4 tint;
void main() {
  gl_Position = projection * view * vec4(place, 1.0);
  tint = colour;
}`;

const TINT_FRAGMENT = `#version 300 es
precision highp float;
in vec4 tint;
out vec4 shown;
void main() { shown = tint; }`;

/** All that lives on the graphics card; made anew when that forgets it. */
class Painter {
  #gl;
  #programs;
  #buffers = {};
  #vertexArrays = {};
  #map;
  #counts = { points: 0, triangles: 0, lines: 0 };
  #faces = [];
  #sceneOrigin = [0, 0, 0];
  #samples;
  #fine = null;

  constructor(gl) {
    this.#gl = gl;
    this.#programs = {
      cloud: program(gl, CLOUD_VERTEX, CLOUD_FRAGMENT),
      line: program(gl, LINE_VERTEX, TINT_FRAGMENT),
      face: program(gl, FACE_VERTEX, TINT_FRAGMENT),
    };
    for (const name of ["place", "normal", "photo", "value", "triangles", "line", "grid", "face"]) this.#buffers[name] = gl.createBuffer();
    this.#samples = Math.min(4, gl.getParameter(gl.MAX_SAMPLES));
    this.#map = gl.createTexture();
    this.#vertexArrays = { cloud: this.#cloudArray(), line: this.#lineArray("line"), grid: this.#lineArray("grid"), face: this.#faceArray() };
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  cloud({ n, m, local, photo, triangles }) {
    const gl = this.#gl;
    this.#counts.points = n;
    this.#counts.triangles = m;
    this.#fill("place", local);
    this.#fill("photo", photo);
    gl.bindVertexArray(this.#vertexArrays.cloud);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.#buffers.triangles);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.DYNAMIC_DRAW);
    gl.bindVertexArray(null);
    this.normals(null);
  }

  /** Normals of the points, or null where there are none. */
  normals(all) {
    if (all) this.#fill("normal", all);
    this.#enable(1, all);
  }

  /** What the colour map shows, or null where it shows nothing. */
  values(all) {
    if (all) this.#fill("value", all.map((x) => (x === x ? x : UNKNOWN)));
    this.#enable(3, all);
  }

  map(bytes) {
    const gl = this.#gl;
    gl.bindTexture(gl.TEXTURE_2D, this.#map);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, which, gl.LINEAR);
    for (const which of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, which, gl.CLAMP_TO_EDGE);
  }

  /** Segments `[from, to, rgb]` and faces `{corners, rgb, opacity}` of the scene. */
  scene(segments, faces) {
    this.#sceneOrigin = segments[0]?.[0] ?? faces[0]?.corners[0] ?? [0, 0, 0];
    this.#fill("line", packedSegments(segments, this.#sceneOrigin));
    this.#counts.lines = segments.length;
    this.#faces = faces;
    const corner = (face, i) => [...plus(face.corners[i], this.#sceneOrigin, -1), ...face.rgb, face.opacity];
    this.#fill("face", new Float32Array(faces.flatMap((face) => [0, 1, 2, 0, 2, 3].flatMap((i) => corner(face, i)))));
  }

  /** Draws all of it. `look` says how: see CloudView. Fine edges take several samples per pixel, and as many times longer. */
  draw(viewer, look) {
    const gl = this.#gl;
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    gl.bindFramebuffer(gl.FRAMEBUFFER, look.fine ? this.#fineTarget(width, height) : null);
    gl.viewport(0, 0, width, height);
    this.#drawAll(viewer, look);
    if (!look.fine) return;
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
  }

  /** What has several samples per pixel, as large as the view. */
  #fineTarget(width, height) {
    const gl = this.#gl;
    this.#fine ??= { frame: gl.createFramebuffer(), colour: gl.createRenderbuffer(), depth: gl.createRenderbuffer() };
    const fine = this.#fine;
    if (fine.width === width && fine.height === height) return fine.frame;
    Object.assign(fine, { width, height });
    gl.bindFramebuffer(gl.FRAMEBUFFER, fine.frame);
    for (const [buffer, format, at] of [[fine.colour, gl.RGBA8, gl.COLOR_ATTACHMENT0], [fine.depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, this.#samples, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, at, gl.RENDERBUFFER, buffer);
    }
    return fine.frame;
  }

  #drawAll(viewer, look) {
    const gl = this.#gl;
    const { near, far, ratio, paper } = look;
    gl.clearColor(...paper, 1);
    gl.depthMask(true);
    gl.colorMask(true, true, true, true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    // The view stays opaque.
    gl.colorMask(true, true, true, false);
    const projection = viewer.perspective(near, far);
    const lines = { projection, near, viewport: [gl.drawingBufferWidth, gl.drawingBufferHeight] };
    if (look.grid.length) {
      const origin = look.grid[0][0];
      this.#fill("grid", packedSegments(look.grid, origin));
      // Behind everything, points beyond the box as well.
      gl.depthMask(false);
      this.#lines("grid", look.grid.length, { ...lines, view: viewer.matrix(origin), width: Math.max(1, ratio) });
      gl.depthMask(true);
    }
    if (look.cloud && this.#counts.points) this.#drawCloud(viewer, projection, look);
    const view = viewer.matrix(this.#sceneOrigin);
    this.#lines("line", this.#counts.lines, { ...lines, view, width: 2.5 * ratio });
    this.#drawFaces(viewer, { view, projection });
  }

  #drawCloud(viewer, projection, look) {
    const gl = this.#gl;
    const points = look.form !== "mesh" || !this.#counts.triangles;
    const uniforms = this.#use("cloud", { view: viewer.matrix(look.cloud.middle), projection, ...look.tint });
    const size = look.cloud.spacing * viewer.focal * look.ratio;
    gl.uniform1f(uniforms.pointSize, size);
    // A few points are drawn large enough to be found.
    const least = Math.max(1.7, Math.min(6, 1.7 * (20000 / this.#counts.points) ** 0.25));
    gl.uniform2f(uniforms.pointLimits, least * look.ratio, 28 * look.ratio);
    gl.uniform1i(uniforms.points, points);
    gl.uniform1i(uniforms.coverage, look.fine);
    gl.uniform1f(uniforms.gain, look.cloud.gain);
    gl.uniform1f(uniforms.light, look.light);
    gl.uniform3fv(uniforms.paper, look.paper);
    gl.uniform3fv(uniforms.haze, look.haze);
    gl.bindTexture(gl.TEXTURE_2D, this.#map);
    gl.bindVertexArray(this.#vertexArrays.cloud);
    if (points) {
      if (look.fine) gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE);
      gl.drawArrays(gl.POINTS, 0, this.#counts.points);
      gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
    } else {
      gl.drawElements(gl.TRIANGLES, 3 * this.#counts.triangles, gl.UNSIGNED_INT, 0);
    }
  }

  #lines(name, count, values) {
    const gl = this.#gl;
    if (!count) return;
    const uniforms = this.#use("line", values);
    gl.uniform2fv(uniforms.viewport, values.viewport);
    gl.uniform1f(uniforms.width, values.width);
    gl.uniform1f(uniforms.near, values.near);
    gl.bindVertexArray(this.#vertexArrays[name]);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
  }

  /** From the back to the front, without hiding one another. */
  #drawFaces(viewer, values) {
    const gl = this.#gl;
    if (!this.#faces.length) return;
    const project = viewer.projection();
    const depth = this.#faces.map((face) => project(between(face.corners[0], face.corners[2], 0.5)).depth);
    this.#use("face", values);
    gl.bindVertexArray(this.#vertexArrays.face);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    for (const i of depth.map((_, k) => k).sort((a, b) => depth[b] - depth[a])) gl.drawArrays(gl.TRIANGLES, 6 * i, 6);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  #use(name, { view, projection, colouring, range, plain, unknown }) {
    const gl = this.#gl;
    const { handle, uniforms } = this.#programs[name];
    gl.useProgram(handle);
    gl.uniformMatrix4fv(uniforms.view, false, view);
    gl.uniformMatrix4fv(uniforms.projection, false, projection);
    if (range) {
      gl.uniform1i(uniforms.colouring, colouring);
      gl.uniform2fv(uniforms.range, range);
      gl.uniform3fv(uniforms.plain, plain);
      gl.uniform3fv(uniforms.unknown, unknown);
    }
    return uniforms;
  }

  #fill(name, data) {
    const gl = this.#gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#buffers[name]);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
  }

  /** Whether an attribute of the cloud is read from its buffer. */
  #enable(at, on) {
    const gl = this.#gl;
    gl.bindVertexArray(this.#vertexArrays.cloud);
    if (on) gl.enableVertexAttribArray(at);
    else gl.disableVertexAttribArray(at);
    gl.vertexAttrib3f(at, 0, 0, 0);
    gl.bindVertexArray(null);
  }

  #cloudArray() {
    const gl = this.#gl;
    return this.#array(() => {
      const attributes = [[0, "place", 3, gl.FLOAT], [1, "normal", 3, gl.FLOAT], [2, "photo", 4, gl.UNSIGNED_BYTE], [3, "value", 1, gl.FLOAT]];
      for (const [at, name, size, type] of attributes) {
        gl.bindBuffer(gl.ARRAY_BUFFER, this.#buffers[name]);
        gl.vertexAttribPointer(at, size, type, type === gl.UNSIGNED_BYTE, 0, 0);
      }
      gl.enableVertexAttribArray(0);
      gl.enableVertexAttribArray(2);
    });
  }

  #lineArray(name) {
    const gl = this.#gl;
    return this.#array(() => {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.#buffers[name]);
      for (const at of [0, 1, 2]) {
        gl.enableVertexAttribArray(at);
        gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 36, 12 * at);
        gl.vertexAttribDivisor(at, 1);
      }
    });
  }

  #faceArray() {
    const gl = this.#gl;
    return this.#array(() => {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.#buffers.face);
      for (const [at, size, from] of [[0, 3, 0], [1, 4, 12]]) {
        gl.enableVertexAttribArray(at);
        gl.vertexAttribPointer(at, size, gl.FLOAT, false, 28, from);
      }
    });
  }

  #array(set) {
    const array = this.#gl.createVertexArray();
    this.#gl.bindVertexArray(array);
    set();
    this.#gl.bindVertexArray(null);
    return array;
  }
}

/** Compiles a program; gives it with the places of its uniforms. */
function program(gl, vertex, fragment) {
  const handle = gl.createProgram();
  const shaders = [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]].map(([kind, source]) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(handle, shader);
    return shader;
  });
  gl.linkProgram(handle);
  if (!gl.getProgramParameter(handle, gl.LINK_STATUS) && !gl.isContextLost()) {
    const log = [...shaders.map((s) => gl.getShaderInfoLog(s)), gl.getProgramInfoLog(handle)].join(" ").trim();
    throw new Error(`expected shaders that WebGL 2 compiles, found: ${log}`);
  }
  const uniforms = {};
  for (let i = 0; i < (gl.getProgramParameter(handle, gl.ACTIVE_UNIFORMS) ?? 0); i++) {
    const { name } = gl.getActiveUniform(handle, i);
    uniforms[name] = gl.getUniformLocation(handle, name);
  }
  return { handle, uniforms };
}

const packedSegments = (segments, origin) =>
  new Float32Array(segments.flatMap(([from, to, rgb]) => [...plus(from, origin, -1), ...plus(to, origin, -1), ...rgb]));

/** The pieces of a line with gaps; a dashed one in as many pieces that the dashes are seen from far and near. */
function segmentsOf({ points, dashed }) {
  const DASHES = 9;
  const whole = points.slice(1).map((p, i) => [points[i], p]).filter(([a, b]) => a && b);
  if (!dashed) return whole;
  return whole.flatMap(([a, b]) =>
    Array.from({ length: DASHES }, (_, i) => [between(a, b, (2 * i) / (2 * DASHES - 1)), between(a, b, (2 * i + 1) / (2 * DASHES - 1))]));
}

// ---- Words and numbers on top

/** Draws text and scales on the canvas that lies on the view. */
class Overlay {
  #context;
  #taken = [];

  constructor(canvas) {
    this.#context = canvas.getContext("2d");
  }

  begin(width, height, ratio, { family, paper }) {
    const c = this.#context;
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, width, height);
    Object.assign(this, { width, height, family, paper });
    this.#taken = [];
  }

  /** Puts a picture under all that was drawn. */
  under(picture) {
    const c = this.#context;
    c.save();
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.globalCompositeOperation = "destination-over";
    if (picture.width && picture.height) c.drawImage(picture, 0, 0);
    c.restore();
  }

  /** Text with a halo of the paper's colour. */
  text(text, x, y, { colour, align = "center", size = 12, weight = 400 }) {
    const c = this.#context;
    c.font = `${weight} ${size}px ${this.family}`;
    [c.textAlign, c.textBaseline, c.lineJoin, c.lineWidth] = [align, "middle", "round", 4];
    [c.strokeStyle, c.fillStyle] = [this.paper, colour];
    c.strokeText(text, x, y);
    c.fillText(text, x, y);
  }

  /** Keeps a place free of names and numbers, by its left upper corner. */
  #reserve(x, y, width, height) {
    this.#taken.push({ x: x + width / 2, y: y + height / 2, width, height });
  }

  /** How far a text about a place reaches in a direction. */
  extent(text, size, [x, y]) {
    this.#context.font = `${size}px ${this.family}`;
    return (Math.abs(x) * this.#context.measureText(text).width) / 2 + Math.abs(y) * size * 0.6;
  }

  /** Text where it covers nothing that keeps its place; says whether it was drawn. */
  ifFree(text, x, y, style) {
    const half = this.extent(text, style.size, [1, 0]) + 3;
    const place = { x, y, width: 2 * half, height: style.size + 2 };
    if (this.#taken.some((other) => overlap(place, other))) return false;
    this.#taken.push(place);
    this.text(text, x, y, style);
    return true;
  }

  /** Text at the first of some places where it is in view and covers nothing. */
  firstFree(text, places, style) {
    const half = this.extent(text, style.size, [1, 0]) + 3;
    const inView = places.filter(([x, y]) => x > half && x < this.width - half && y > 10 && y < this.height - 10);
    const [[x, y]] = places;
    const moved = [Math.max(half, Math.min(this.width - half, x)), y];
    return [...inView, moved].some(([left, top]) => this.ifFree(text, left, top, style));
  }

  /** Names of things beside the places they are at, where they cover no other name. */
  labels(labels, project) {
    const c = this.#context;
    const shown = labels.map((label) => ({ ...label, ...project(label.at) })).filter(({ depth }) => depth > 0);
    for (const { x, y, colour } of shown) {
      c.beginPath();
      c.arc(x, y, 3.5, 0, 2 * Math.PI);
      [c.fillStyle, c.strokeStyle, c.lineWidth] = [colour, this.paper, 1.5];
      c.stroke();
      c.fill();
    }
    c.font = `600 13px ${this.family}`;
    const dots = shown.map(({ x, y }) => ({ x, y, width: 8, height: 8 }));
    for (const { text, x, y, colour } of shown) {
      const width = c.measureText(text).width + 6;
      // What is so far outside that its name would not be seen either needs none.
      if (beyond(x, this.width) > width / 2 || beyond(y, this.height) > 17) continue;
      const within = (p) => ({ ...p, x: clamped(p.x, width / 2, this.width - width / 2), y: clamped(p.y, 9, this.height - 9) });
      const beside = [[0, -15], [0, 15], [width / 2 + 8, 0], [-width / 2 - 8, 0], [0, -31], [0, 31]];
      const places = beside.map(([dx, dy]) => ({ x: x + dx, y: y + dy, width, height: 17 }));
      // A name that would be cut moves into the view; a place where it need not move goes first.
      const whole = (p) => p.x === within(p).x && p.y === within(p).y;
      const tried = [...places.filter(whole), ...places.filter((p) => !whole(p)).map(within)];
      const place = tried.find((p) => ![...this.#taken, ...dots].some((other) => overlap(p, other))) ?? tried[0];
      this.#taken.push(place);
      this.text(text, place.x, place.y, { colour, size: 13, weight: 600 });
    }
  }

  /** A ring about a point. */
  ring({ x, y }, colour) {
    const c = this.#context;
    for (const [stroke, width] of [[this.paper, 4.5], [colour, 2]]) {
      c.beginPath();
      c.arc(x, y, 7, 0, 2 * Math.PI);
      [c.strokeStyle, c.lineWidth] = [stroke, width];
      c.stroke();
    }
  }

  /** A bar of a round length. */
  scale(perMm, { ink }) {
    const c = this.#context;
    const longest = Math.min(140, this.width / 4);
    const length = niceStep(longest / perMm / 2);
    const [x, y] = [14, this.height - 14];
    for (const [stroke, width] of [[this.paper, 5], [ink, 2]]) {
      c.beginPath();
      c.moveTo(x, y - 5);
      c.lineTo(x, y);
      c.lineTo(x + length * perMm, y);
      c.lineTo(x + length * perMm, y - 5);
      [c.strokeStyle, c.lineWidth, c.lineJoin] = [stroke, width, "miter"];
      c.stroke();
    }
    const name = `${numeral(length, length)} mm`;
    this.text(name, x + (length * perMm) / 2, y - 13, { colour: ink });
    const wide = Math.max(length * perMm, 2 * this.extent(name, 12, [1, 0]));
    this.#reserve(x + (length * perMm - wide) / 2 - 3, y - 21, wide + 6, 25);
  }

  /** The colours with their numbers: at the right, or above where there is little width. */
  bar({ title, range: [low, high], map }, { ink, muted }) {
    const c = this.#context;
    const flat = this.width < NARROW_PX;
    const long = flat ? this.width - 40 : Math.min(220, this.height * 0.5);
    const step = niceStep((high - low) / Math.max(2, long / (flat ? 52 : 34)));
    const marks = ticks(low, high, step).map((value) => ({ value, text: numeral(value, step) }));
    const widest = 2 * Math.max(0, ...marks.map(({ text }) => this.extent(text, 12, [1, 0])));
    const [x, y] = flat ? [20, 28] : [this.width - Math.max(66, widest + 31), (this.height - long) / 2];
    if (flat) this.#reserve(0, 0, this.width, y + 30);
    else this.#reserve(x - 4, y - 24, this.width - x + 4, long + 34);
    for (let i = 0; i < long; i++) {
      const at = 4 * Math.round((255 * i) / (long - 1));
      c.fillStyle = `rgb(${map[at]},${map[at + 1]},${map[at + 2]})`;
      if (flat) c.fillRect(x + i, y, 1.2, 10);
      else c.fillRect(x, y + long - 1 - i, 12, 1.2);
    }
    for (const { value, text } of marks) {
      const share = (value - low) / (high - low);
      const at = flat ? x + share * long : y + (1 - share) * long;
      c.fillStyle = muted;
      if (flat) c.fillRect(at - 0.5, y + 10, 1, 4);
      else c.fillRect(x + 12, at - 0.5, 4, 1);
      if (flat) this.text(text, Math.min(at, this.width - widest / 2 - 4), y + 22, { colour: ink });
      else this.text(text, x + 19, at, { colour: ink, align: "left" });
    }
    if (flat) this.text(title, x, y - 11, { colour: ink, align: "left", weight: 600 });
    else this.text(title, this.width - 12, y - 16, { colour: ink, align: "right", weight: 600 });
  }
}

const clamped = (v, low, high) => Math.max(low, Math.min(high, v));
/** How far a coordinate lies outside of a view of this size. */
const beyond = (v, size) => Math.max(0, -v, v - size);
const overlap = (a, b) => Math.abs(a.x - b.x) * 2 < a.width + b.width && Math.abs(a.y - b.y) * 2 < a.height + b.height;

/** The sides of a box behind its contents, their grids in mm, and where the numbers of each axis stand. */
function axesOf(box, viewer) {
  const project = viewer.projection();
  const { eye, directions: { forward } } = viewer;
  // Per axis: the side at the back and the one at the front.
  const [back, front] = [[], []];
  for (let k = 0; k < 3; k++) {
    const farHigh = eye[k] < box.low[k] || (eye[k] <= box.high[k] && forward[k] > 0);
    [back[k], front[k]] = farHigh ? [box.high[k], box.low[k]] : [box.low[k], box.high[k]];
  }
  const perMm = viewer.focal / Math.max(project(between(box.low, box.high, 0.5)).depth, 1e-6);
  const [grid, numbers] = [[], []];
  const steps = [0, 1, 2].map((k) => Math.max(niceStep(60 / perMm), niceStep((box.high[k] - box.low[k]) / 40)));
  const lines = [0, 1, 2].map((k) => [box.low[k], ...ticks(box.low[k], box.high[k], steps[k]), box.high[k]]);
  for (let k = 0; k < 3; k++) {
    const [i, j] = [(k + 1) % 3, (k + 2) % 3];
    const at = (x, y, z) => Object.assign([], { [i]: x, [j]: y, [k]: z });
    // On the side at the back of axis k.
    for (const x of lines[i]) grid.push([at(x, box.low[j], back[k]), at(x, box.high[j], back[k])]);
    for (const y of lines[j]) grid.push([at(box.low[i], y, back[k]), at(box.high[i], y, back[k])]);
    // Numbers stand at an edge of the outline: one of its sides is at the back, the other at the front.
    const edges = [[back[i], front[j]], [front[i], back[j]]].map(([x, y]) => [at(x, y, box.low[k]), at(x, y, box.high[k])]);
    const middles = edges.map(([a, b]) => project(between(a, b, 0.5)));
    const first = k === 1 ? middles[0].x < middles[1].x : middles[0].y > middles[1].y;
    const [x, y] = first ? [back[i], front[j]] : [front[i], back[j]];
    const [low, high] = [at(x, y, box.low[k]), at(x, y, box.high[k])];
    const step = steps[k];
    numbers.push({ k, low, high, step, marks: ticks(box.low[k], box.high[k], step).map((z) => ({ at: at(x, y, z), text: numeral(z, step) })) });
  }
  return { grid, numbers };
}

/** Writes the names and numbers of the axes, outside of the box; numbers that would cover something are left out. */
function drawAxes(overlay, viewer, box, numbers, { muted }) {
  const project = viewer.projection();
  const centre = project(between(box.low, box.high, 0.5));
  const edges = numbers.map((axis) => ({ ...axis, ...outside(project(axis.low), project(axis.high), centre) })).filter(({ long }) => long >= 36);
  for (const { k, a, b, out, marks } of edges) {
    // Beside the numbers, whichever way the edge runs; or beyond one of its ends.
    const widest = Math.max(0, ...marks.map(({ text }) => overlay.extent(text, 11, out)));
    const off = 8 + 2 * widest + overlay.extent(AXES[k], 12, out);
    const [upper, lower] = a.y < b.y ? [a, b] : [b, a];
    const beside = [(a.x + b.x) / 2 + out[0] * off, (a.y + b.y) / 2 + out[1] * off];
    const [above, below] = [[upper, -16], [lower, 16]].map(([end, down]) => [end.x + out[0] * (5 + widest), end.y + out[1] * (5 + widest) + down]);
    overlay.firstFree(AXES[k], k === 1 ? [above, beside, below] : [beside, below, above], { colour: muted, size: 12 });
  }
  for (const { out, marks } of edges) {
    for (const { at, text } of marks) {
      const p = project(at);
      const off = 5 + overlay.extent(text, 11, out);
      overlay.ifFree(text, p.x + out[0] * off, p.y + out[1] * off, { colour: muted, size: 11 });
    }
  }
}

/** An edge on the screen, how long it is (0 where it is not in front of the viewer), and the way from it out of the box. */
function outside(a, b, centre) {
  const ahead = a.depth > 0 && b.depth > 0 && centre.depth > 0;
  const long = ahead ? Math.hypot(b.x - a.x, b.y - a.y) : 0;
  const out = [-(b.y - a.y) / long, (b.x - a.x) / long];
  const outward = out[0] * ((a.x + b.x) / 2 - centre.x) + out[1] * ((a.y + b.y) / 2 - centre.y) >= 0;
  return { a, b, long, out: outward ? out : out.map((x) => -x) };
}

// ---- The view

let views = 0;

/** An element with attributes, of which `data` are data attributes, and children. */
function element(tag, { data = {}, ...attributes } = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  Object.assign(made.dataset, data);
  made.append(...children);
  return made;
}

/**
 * A cloud in space with its controls, in an element of the page.
 *
 * What it shows stands in data attributes, too: `[data-state=cloud]` with `data-points`, `data-triangles`, `data-colour`,
 * `data-form` and `data-frames` (drawn so far); `[data-state=colour-range]`; `[data-state=point]`, what is at the pointer;
 * `[data-state=view-message]`, why nothing is drawn.
 */
class CloudView {
  #options;
  #parts = {};
  #viewer = new Viewer();
  #painter = null;
  #overlay;
  #palette;
  #colours = {};
  #family = "sans-serif";
  #cloud = null;
  #scene = { lines: [], faces: [], labels: [] };
  #sceneBox = null;
  /** Names of the scene that are shown, their colours as the page has them now. */
  #labels = [];
  #legend = "";
  #hidden = new Set();
  #wanted = { colour: null, form: "points", axes: true };
  #map = null;
  #marked = null;
  #pointers = new Map();
  #press = null;
  #lastClick = null;
  #toFit = true;
  #touched = false;
  #ratio = 1;
  #request = 0;
  /** Whether edges are coarse while the view turns, as the graphics card is slow. */
  #slow = false;
  #moving = false;
  #coarse = false;
  #rest = 0;
  #frames = 0;
  #times = [];
  #printing = false;
  #ended = new AbortController();
  #observers = [];

  /**
   * Builds the view as the last child of `container`, which gives its width and, where it has one, its height.
   *
   * `label` says what is seen, for those who do not see it. `choices` are the colourings that are offered, in order, where the
   * cloud has them; the first is the one it begins with. `whole` begins with devices and sheets in view, not with the cloud alone.
   */
  constructor(container, { label = "3D view", choices = Object.keys(COLOURINGS), whole = false } = {}) {
    this.#options = { label, choices };
    this.#wanted.whole = whole;
    this.#build(container);
    this.#palette = new Palette(this.#parts.root);
    this.#overlay = new Overlay(this.#parts.over);
    this.#start();
    this.#listen();
    this.#observe();
    this.#recolour();
    this.#tell();
  }

  /**
   * Shows a cloud in the binary form of `/api/clouds/N`, or none for null. The first one is fitted into the view, later ones are
   * seen from where the one before was. `values` are further colourings, one number (or NaN) per point:
   * `{noise: {text: "noise", unit: "mm", values: Float32Array}}`. A malformed cloud throws, and what was shown stays.
   */
  setCloud(buffer, { values = {} } = {}) {
    const first = !this.#cloud?.n;
    const read = buffer === null ? null : readCloud(buffer);
    const cloud = read && prepared(read, checkedValues(values, read.n));
    this.#mark(null);
    this.#cloud = cloud;
    if (first && this.#cloud?.n) this.#fitLater();
    this.#upload();
    this.#tell();
    this.#changed();
  }

  /**
   * Shows lines, faces and names beside the cloud; colours are as in style sheets, `var(--camera)` among them. Things of one name
   * are one entry of the legend. A `null` among the points of a line is a gap.
   */
  setScene({ lines = [], faces = [], labels = [] }) {
    this.#scene = { lines, faces, labels };
    const points = [...lines.flatMap((line) => line.points.filter(Boolean)), ...faces.flatMap((face) => face.corners), ...labels.map(({ at }) => at)];
    this.#sceneBox = points.length ? boxOf(points) : null;
    if (!this.#touched && (this.#wanted.whole || !this.#cloud?.n)) this.#fitLater();
    this.#uploadScene();
    this.#tell();
    this.#changed();
  }

  /** Colours by "photograph", "depth", "sigma", "plain" or a name of `values`. Where the cloud does not have it, by the first choice that it has. */
  colorBy(name) {
    if (!this.#choices().includes(name)) throw new Error(`expected a colouring out of ${this.#choices().join(", ")}, found ${name}`);
    this.#wanted.colour = name;
    this.#uploadColour();
    this.#tell();
    this.#changed();
  }

  /** Shows "points", or a "mesh" where the cloud has triangles. */
  showAs(form) {
    if (form !== "points" && form !== "mesh") throw new Error(`expected points or mesh, found ${form}`);
    this.#wanted.form = form;
    this.#tell();
    this.#changed();
  }

  /** Back to the first view of what is shown now. */
  reset() {
    this.#fitLater();
    this.#changed();
  }

  /** How much is shown, and how many frames per second were drawn in the last two seconds (0 where nothing changed for a second). */
  stats() {
    const { n = 0, m = 0 } = this.#cloud ?? {};
    const now = performance.now();
    const [first, last] = [this.#times[0], this.#times.at(-1)];
    const busy = this.#times.length > 1 && now - last < 1000;
    return { points: n, triangles: m, framesPerSecond: busy ? (1000 * (this.#times.length - 1)) / (last - first) : 0 };
  }

  /** From where it is seen: degrees to the left of and above the camera's line of sight, mm from the turning point, and that. */
  pose() {
    const { yaw, pitch, distance, pivot } = this.#viewer;
    return { left: yaw / DEGREE, above: pitch / DEGREE, distance, pivot: [...pivot] };
  }

  /** What is seen, with names and scales, as data URL of a PNG. */
  picture() {
    this.#drawNow(true);
    const { canvas, over } = this.#parts;
    const sheet = element("canvas");
    [sheet.width, sheet.height] = [over.width, over.height];
    const c = sheet.getContext("2d");
    c.fillStyle = this.#colours.css.paper;
    c.fillRect(0, 0, sheet.width, sheet.height);
    for (const layer of [canvas, over]) if (layer.width && layer.height) c.drawImage(layer, 0, 0);
    return sheet.toDataURL("image/png");
  }

  /** Removes the view from the page and lets go of the graphics card. */
  dispose() {
    this.#ended.abort();
    for (const observer of this.#observers) observer.disconnect();
    cancelAnimationFrame(this.#request);
    clearTimeout(this.#rest);
    this.#painter = null;
    this.#parts.canvas.getContext("webgl2")?.getExtension("WEBGL_lose_context")?.loseContext();
    this.#parts.root.remove();
  }

  // -- Elements

  #build(container) {
    const id = `cloud-view-${++views}`;
    const parts = this.#parts;
    parts.canvas = element("canvas", { class: "cloud-view-space", "aria-hidden": "true" });
    parts.over = element("canvas", { class: "cloud-view-words", "aria-hidden": "true" });
    parts.message = element("p", { class: "cloud-view-message", role: "status", data: { state: "view-message" } });
    parts.point = element("p", { class: "cloud-view-point", "aria-hidden": "true", data: { state: "point" } });
    parts.stage = element(
      "div",
      {
        class: "cloud-view-stage", tabindex: "0", role: "application", "aria-roledescription": "3D view", "aria-describedby": `${id}-help`,
        data: { action: "view" },
      },
      parts.canvas, parts.over, parts.point, parts.message,
    );
    parts.colours = element("div", { class: "cloud-view-group", role: "group", "aria-label": "Colour" });
    parts.forms = element("div", { class: "cloud-view-group", role: "group", "aria-label": "Form" });
    for (const form of ["points", "mesh"]) parts.forms.append(this.#button(form, "show-as", () => this.showAs(form), { value: form }));
    parts.whole = this.#button("whole scene", "view-whole", () => this.#show(!this.#wanted.whole));
    parts.axes = this.#button("axes", "view-axes", () => this.#toggleAxes());
    parts.reset = this.#button("reset", "view-reset", () => this.reset());
    parts.helper = this.#button("help", "view-help", () => this.#toggleHelp());
    parts.helper.setAttribute("aria-controls", `${id}-help`);
    const others = [parts.whole, parts.axes, parts.reset, parts.helper];
    parts.others = element("div", { class: "cloud-view-group", role: "group", "aria-label": "View" }, ...others);
    parts.bar = element("div", { class: "cloud-view-bar" }, parts.colours, parts.forms, parts.others);
    // It scrolls where there is little room, by keyboard, too.
    parts.help = element("p", { class: "cloud-view-help", id: `${id}-help`, tabindex: "0", role: "note", "aria-label": "Help" }, HELP);
    parts.legend = element("ul", { class: "cloud-view-legend", "aria-label": "Legend" });
    parts.range = element("span", { class: "cloud-view-heard", data: { state: "colour-range" } });
    parts.told = element("p", { class: "cloud-view-heard", role: "status" });
    parts.root = element(
      "div", { class: "cloud-view", role: "group", "aria-label": this.#options.label, data: { state: "cloud" } },
      parts.bar, parts.help, parts.stage, parts.legend, parts.range, parts.told,
    );
    parts.help.hidden = parts.message.hidden = parts.point.hidden = true;
    parts.helper.setAttribute("aria-expanded", "false");
    parts.root.addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || parts.help.hidden) return;
      event.preventDefault();
      this.#toggleHelp();
      if (!parts.root.contains(document.activeElement) || document.activeElement === parts.help) parts.helper.focus();
    });
    container.append(parts.root);
  }

  #button(text, action, does, data = {}) {
    const made = element("button", { type: "button", data: { action, ...data } }, text);
    made.addEventListener("click", does);
    return made;
  }

  #toggleHelp() {
    const { help, helper } = this.#parts;
    help.hidden = !help.hidden;
    helper.setAttribute("aria-expanded", String(!help.hidden));
  }

  #toggleAxes() {
    this.#wanted.axes = !this.#wanted.axes;
    this.#tell();
    this.#changed();
  }

  /** The whole scene, or the cloud alone. */
  #show(whole) {
    this.#wanted.whole = whole;
    this.#tell();
    this.reset();
  }

  // -- What is shown

  #choices() {
    return [...new Set([...this.#options.choices, ...Object.keys(this.#cloud?.measured ?? {}), ...Object.keys(COLOURINGS)])];
  }

  /** The colourings that are offered: of the choices, those that the cloud has, and those that came with it. */
  #offered() {
    const cloud = this.#cloud;
    if (!cloud?.n) return [];
    const extra = Object.keys(cloud.measured).filter((name) => !(name in COLOURINGS));
    const last = (name) => name === "plain";
    const all = new Set([...this.#options.choices.filter((name) => !last(name)), ...extra, ...this.#options.choices.filter(last)]);
    return [...all].filter((name) => cloud.offers[name]);
  }

  get #colour() {
    const { colour } = this.#wanted;
    return this.#cloud?.offers[colour] ? colour : this.#offered()[0] ?? "plain";
  }

  get #form() {
    return this.#cloud?.m ? this.#wanted.form : "points";
  }

  /** Writes what is shown into controls, legend and attributes. */
  #tell() {
    const { root, forms, whole, axes, stage, range } = this.#parts;
    const { points, triangles } = this.stats();
    const [colour, form] = [this.#colour, this.#form];
    Object.assign(root.dataset, { points, triangles, colour, form });
    this.#tellColours(colour);
    forms.hidden = !triangles;
    for (const button of forms.children) button.setAttribute("aria-pressed", String(button.dataset.value === form));
    whole.hidden = !points || !this.#sceneBox;
    whole.setAttribute("aria-pressed", String(this.#wanted.whole));
    axes.setAttribute("aria-pressed", String(this.#wanted.axes));
    this.#tellLegend();
    const size = triangles ? `${points} points, ${triangles} triangles` : `${points} points`;
    const words = [this.#options.label];
    const measured = this.#cloud?.n ? this.#cloud.measured[colour] : null;
    if (points) words.push(`${size}, shown as ${form}`);
    if (measured) {
      const [low, high] = measured.range;
      const step = niceStep((high - low) / 100);
      const scale = `${measured.text} from ${numeral(low, step)} to ${numeral(high, step)} ${measured.unit ?? ""}`.trim();
      words.push(`coloured by ${scale}`);
      range.textContent = scale;
      Object.assign(range.dataset, { low, high, unit: measured.unit ?? "" });
    } else {
      range.textContent = "";
      for (const key of ["low", "high", "unit"]) delete range.dataset[key];
      if (points) words.push(colour === "plain" ? "in one colour" : "coloured by the photograph");
    }
    stage.setAttribute("aria-label", `${words.join("; ")}.`);
  }

  #tellColours(colour) {
    const { colours } = this.#parts;
    const offered = this.#offered();
    const names = [...colours.children].map((b) => b.dataset.value);
    // Buttons stay while they are the same: one of them may have the focus.
    if (names.join() !== offered.join()) {
      colours.replaceChildren(...offered.map((name) => {
        const { text } = COLOURINGS[name] ?? this.#cloud.measured[name];
        return this.#button(text, "colour-by", () => this.colorBy(name), { value: name });
      }));
    }
    colours.hidden = offered.length < 2;
    for (const button of colours.children) button.setAttribute("aria-pressed", String(button.dataset.value === colour));
  }

  #tellLegend() {
    const { legend } = this.#parts;
    const entries = new Map(this.#scene.lines.map(({ name, color, dashed }) => [name, { color, dashed }]));
    for (const { name, color } of this.#scene.faces) if (!entries.has(name)) entries.set(name, { color });
    if (entries.size && this.#cloud?.n) entries.set(POINTS, { color: "var(--cloud)", cloud: true });
    const key = JSON.stringify([...entries]);
    if (this.#legend !== key) {
      this.#legend = key;
      legend.replaceChildren(...[...entries].map(([name, entry]) => {
        const swatch = element("span", { class: entry.cloud ? "cloud-view-key dots" : "cloud-view-key" });
        swatch.style.borderColor = entry.color;
        swatch.style.borderStyle = entry.dashed ? "dashed" : entry.cloud ? "dotted" : "solid";
        const button = this.#button("", "show-line", () => this.#toggle(name), { name });
        button.append(swatch, name);
        return element("li", {}, button);
      }));
    }
    legend.hidden = !entries.size;
    for (const button of legend.querySelectorAll("button")) button.setAttribute("aria-pressed", String(!this.#hidden.has(button.dataset.name)));
  }

  /** Shows or hides what has a name in the legend. */
  #toggle(name) {
    if (!this.#hidden.delete(name)) this.#hidden.add(name);
    this.#uploadScene();
    this.#tell();
    this.#changed();
  }

  // -- Graphics card

  #start() {
    const { canvas } = this.#parts;
    const gl = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true });
    if (!gl) {
      this.#message("Expected a browser with WebGL 2, found none: nothing can be drawn in 3D. Update the browser, or switch on its hardware acceleration.");
      return;
    }
    try {
      this.#painter = new Painter(gl);
      this.#message("");
    } catch (error) {
      this.#message(`The 3D view cannot be drawn: ${error.message}`);
    }
  }

  #message(text) {
    const { message } = this.#parts;
    message.textContent = text;
    message.hidden = !text;
  }

  #upload() {
    if (!this.#painter) return;
    if (this.#cloud) this.#painter.cloud(this.#cloud);
    this.#uploadColour();
  }

  #uploadColour() {
    const measured = this.#cloud?.measured[this.#colour];
    this.#painter?.values(measured ? measured.values : null);
  }

  /** Normals take a while and are needed once shape is to be seen. */
  #uploadNormals() {
    const cloud = this.#cloud;
    if (!cloud?.m || cloud.lit === this.#painter) return;
    cloud.normals ??= normals(cloud);
    this.#painter.normals(cloud.normals);
    cloud.lit = this.#painter;
  }

  #uploadScene() {
    if (!this.#painter) return;
    const shown = ({ name }) => !this.#hidden.has(name);
    const rgb = (colour) => this.#palette.rgb(colour);
    const segments = this.#scene.lines.filter(shown).flatMap((line) => {
      const colour = rgb(line.color);
      return segmentsOf(line).map(([a, b]) => [a, b, colour]);
    });
    const faces = this.#scene.faces.filter(shown).map((face) => ({ corners: face.corners, opacity: face.opacity ?? 0.25, rgb: rgb(face.color) }));
    this.#painter.scene(segments, faces);
    const labels = this.#scene.labels.filter(({ text }) => !this.#hidden.has(text));
    this.#labels = labels.map(({ text, color, at }) => ({ text, at, colour: this.#palette.css(color) }));
  }

  /** Takes the page's colours, at the start and when they change. */
  #recolour() {
    const names = { paper: "#ffffff", ink: "#1b1f24", muted: "#545d68", line: "#d4d8de", cloud: "#3f6f8f", surface: "#b9c2cc" };
    const [css, rgb] = [{}, {}];
    for (const [name, otherwise] of Object.entries(names)) {
      css[name] = this.#palette.css(`var(--${name}, ${otherwise})`);
      rgb[name] = this.#palette.rgb(css[name]);
    }
    const dark = rgb.paper[0] + rgb.paper[1] + rgb.paper[2] < 1.5;
    this.#colours = { css, rgb };
    this.#map = colourMap(dark);
    this.#family = getComputedStyle(this.#parts.root).fontFamily;
    this.#painter?.map(this.#map);
    this.#uploadScene();
    this.#changed();
  }

  // -- What is in view

  /** The box that the view is fitted to and the axes stand around. */
  #focus() {
    const cloud = this.#cloud?.n ? this.#cloud.box : null;
    const scene = this.#sceneBox;
    const boxes = (cloud && !this.#wanted.whole ? [cloud] : [cloud, scene]).filter(Boolean);
    const all = boxes.length ? boxOf(boxes.flatMap(cornersOf)) : NOTHING;
    // A single point or a line has no size; axes need one.
    const least = Math.max(1, ...all.high.map((high, k) => (high - all.low[k]) * 0.02));
    const room = all.low.map((low, k) => Math.max(0, least - (all.high[k] - low)) / 2);
    return { low: plus(all.low, room, -1), high: plus(all.high, room) };
  }

  /** How far contents reach from a point, so that nothing is cut off. */
  #reach(from) {
    const far = (box) => Math.max(...cornersOf(box).map((p) => Math.hypot(...plus(p, from, -1))));
    const cloud = this.#cloud;
    const scene = this.#sceneBox;
    return Math.max(
      far(this.#focus()), scene ? far(scene) : 0, cloud?.n ? Math.hypot(...plus(cloud.middle, from, -1)) + cloud.reach : 0,
    );
  }

  #fitLater() {
    this.#toFit = true;
    this.#touched = false;
  }

  #fit() {
    const focus = this.#focus();
    const cloudAlone = this.#cloud?.n && !this.#wanted.whole;
    const narrow = this.#viewer.width < NARROW_PX;
    // Room for the numbers of the axes and for the colour bar.
    this.#viewer.fit(cornersOf(focus), cloudAlone ? BEGIN.cloud : BEGIN.all, narrow ? [44, 64] : [90, 48]);
    this.#toFit = false;
  }

  #zoomLimits() {
    const { low, high } = this.#focus();
    const size = Math.hypot(...plus(high, low, -1));
    return [size * 0.004, size * 40];
  }

  /** The point of the cloud at a place of the view: of those nearby, the one in front. */
  #pick(x, y) {
    const cloud = this.#cloud;
    if (!cloud?.n || this.#hidden.has(POINTS)) return null;
    const viewer = this.#viewer;
    const { right, down, forward } = viewer.directions;
    const eye = plus(viewer.eye, cloud.middle, -1);
    const { local } = cloud;
    const focal = viewer.focal;
    const left = x - viewer.width / 2, top = y - viewer.height / 2;
    let best = -1, score = Infinity;
    for (let i = 0; i < local.length; i += 3) {
      const dx = local[i] - eye[0], dy = local[i + 1] - eye[1], dz = local[i + 2] - eye[2];
      const depth = dx * forward[0] + dy * forward[1] + dz * forward[2];
      if (depth <= 0) continue;
      const u = (focal * (dx * right[0] + dy * right[1] + dz * right[2])) / depth - left;
      if (u > PICK_PX || u < -PICK_PX) continue;
      const v = (focal * (dx * down[0] + dy * down[1] + dz * down[2])) / depth - top;
      const off = Math.sqrt(u * u + v * v);
      if (off > PICK_PX) continue;
      // A point that is behind by less than it is nearer to the pointer on the screen wins.
      const now = depth + (2 * off * depth) / focal;
      if (now < score) [best, score] = [i / 3, now];
    }
    return best < 0 ? null : best;
  }

  #place(index) {
    return [0, 1, 2].map((k) => this.#cloud.places[3 * index + k]);
  }

  /** Marks a point and says where it is. */
  #mark(index) {
    if (index === this.#marked) return;
    this.#marked = index;
    const { point } = this.#parts;
    point.hidden = index === null;
    if (index !== null) {
      const text = "xyz".split("").map((axis, k) => `${axis} ${numeral(this.#place(index)[k], 0.1)}`);
      text[2] += " mm";
      for (const [name, { text: word, unit = "", values }] of Object.entries(this.#cloud.measured)) {
        if (name !== "depth" && values[index] === values[index]) text.push(`${word} ${numeral(values[index], 0.001)} ${unit}`.trim());
      }
      point.textContent = text.join(", ");
      point.dataset.index = index;
    }
    this.#changed();
  }

  // -- Drawing

  #changed() {
    this.#request ||= requestAnimationFrame(() => this.#drawNow());
  }

  #drawNow(fine = !(this.#slow && this.#moving)) {
    cancelAnimationFrame(this.#request);
    this.#request = 0;
    const viewer = this.#viewer;
    if (!this.#painter || !this.#parts.over.width || !this.#parts.canvas.width) return;
    if (this.#toFit) this.#fit();
    if (this.#cloud?.m) this.#uploadNormals();
    const { css, rgb } = this.#colours;
    const focus = this.#focus();
    const empty = !this.#cloud?.n && !this.#sceneBox;
    const axes = this.#wanted.axes && !empty ? axesOf(focus, viewer) : { grid: [], numbers: [] };
    this.#painter.draw(viewer, { ...this.#look(focus, axes.grid.map(([a, b]) => [a, b, rgb.line])), fine });
    this.#coarse = !fine;
    if (this.#moving && fine) this.#time();
    const overlay = this.#overlay;
    overlay.begin(viewer.width, viewer.height, this.#ratio, { family: this.#family, paper: css.paper });
    // These have their places; names and numbers take what is left.
    if (!empty) overlay.scale(viewer.focal / viewer.distance, css);
    const measured = this.#cloud?.n && !this.#hidden.has(POINTS) ? this.#cloud.measured[this.#colour] : null;
    if (measured) {
      const title = measured.unit ? `${measured.text}, ${measured.unit}` : measured.text;
      overlay.bar({ title, range: measured.range, map: this.#map }, css);
    }
    drawAxes(overlay, viewer, focus, axes.numbers, css);
    overlay.labels(this.#labels, viewer.projection());
    if (this.#marked !== null) overlay.ring(viewer.projection()(this.#place(this.#marked)), css.ink);
    if (empty) overlay.text("no points", viewer.width / 2, viewer.height / 2, { colour: css.muted, size: 14 });
    this.#count();
  }

  /** Takes a card as slow if the next frame comes late. */
  #time() {
    const start = performance.now();
    requestAnimationFrame(() => {
      if (performance.now() - start > SLOW_MS) this.#slow = true;
    });
  }

  #look(focus, grid) {
    const { rgb } = this.#colours;
    const [colour, form] = [this.#colour, this.#form];
    const cloud = this.#cloud?.n && !this.#hidden.has(POINTS) ? this.#cloud : null;
    const viewer = this.#viewer;
    const reach = this.#reach(viewer.eye);
    const measured = cloud?.measured[colour];
    // What is far away fades a little, where colours are numbers, hardly. Light changes those less, and a photograph has its own.
    const depths = cornersOf(cloud ? cloud.box : focus).map((p) => viewer.projection()(p).depth);
    const fade = measured ? 0.1 : colour === "photograph" ? 0.25 : 0.4;
    const [onPoints, onMesh] = measured ? [0.25, 0.45] : colour === "photograph" ? [0, 0.5] : [0.8, 1];
    return {
      grid, form, cloud, ratio: this.#ratio, paper: rgb.paper,
      near: Math.max(reach * 2e-4, viewer.distance * 0.01), far: reach * 1.01,
      haze: [Math.min(...depths), Math.max(...depths), fade],
      light: form === "mesh" ? onMesh : onPoints,
      tint: {
        colouring: colour === "photograph" ? 0 : measured ? 1 : 2,
        range: measured ? measured.range : [0, 1],
        plain: form === "mesh" ? rgb.surface : rgb.cloud,
        unknown: rgb.muted,
      },
    };
  }

  /** Remembers when frames were drawn, as long as one follows the other. */
  #count() {
    const now = performance.now();
    if (now - (this.#times.at(-1) ?? 0) > 1000) this.#times = [];
    this.#times = [...this.#times.filter((t) => now - t < 2000), now];
    this.#parts.root.dataset.frames = ++this.#frames;
  }

  /** Takes the size of the stage; draws at once, so that a page that changes its size does not flicker. */
  #resize() {
    if (this.#printing) return;
    const { stage, canvas, over } = this.#parts;
    const [width, height] = [stage.clientWidth, stage.clientHeight];
    this.#ratio = Math.min(window.devicePixelRatio || 1, MAX_PIXEL_RATIO);
    const size = [Math.round(width * this.#ratio), Math.round(height * this.#ratio)];
    if (canvas.width === size[0] && canvas.height === size[1]) return;
    for (const layer of [canvas, over]) [layer.width, layer.height] = size;
    [this.#viewer.width, this.#viewer.height] = [Math.max(1, width), Math.max(1, height)];
    if (!this.#touched) this.#toFit = true;
    this.#slow = false;
    this.#drawNow();
  }

  // -- What happens

  #observe() {
    const sizes = new ResizeObserver(() => this.#resize());
    sizes.observe(this.#parts.stage);
    // Pages may change their colours by a class.
    const classes = new MutationObserver(() => this.#recolour());
    classes.observe(document.documentElement, { attributes: true, attributeFilter: ["class", "style", "data-theme"] });
    this.#observers = [sizes, classes];
  }

  #listen() {
    const { stage, canvas } = this.#parts;
    const signal = this.#ended.signal;
    const on = (target, kind, does, options = {}) => target.addEventListener(kind, does, { signal, ...options });
    on(stage, "pointerdown", (event) => this.#pressed(event));
    on(stage, "pointermove", (event) => this.#moved(event));
    for (const kind of ["pointerup", "pointercancel"]) on(stage, kind, (event) => this.#released(event));
    on(stage, "pointerleave", () => this.#pointers.size || this.#mark(null));
    on(stage, "contextmenu", (event) => event.preventDefault());
    on(stage, "wheel", (event) => this.#wheeled(event), { passive: false });
    on(stage, "keydown", (event) => this.#keyed(event));
    on(canvas, "webglcontextlost", (event) => {
      event.preventDefault();
      this.#painter = null;
      this.#message("The graphics card has dropped the 3D view; it comes back by itself. If it does not, load the page again.");
    });
    on(canvas, "webglcontextrestored", () => {
      this.#start();
      this.#upload();
      this.#recolour();
    });
    on(matchMedia("(prefers-color-scheme: dark)"), "change", () => this.#recolour());
    on(window, "beforeprint", () => this.#print(true));
    on(window, "afterprint", () => this.#print(false));
    this.#watchRatio();
  }

  /** Another screen may have other pixels. */
  #watchRatio() {
    const once = { signal: this.#ended.signal, once: true };
    matchMedia(`(resolution: ${window.devicePixelRatio}dppx)`).addEventListener("change", () => {
      this.#resize();
      this.#watchRatio();
    }, once);
  }

  /**
   * Paper is white: pages give their light colours to a root of the class on-paper. Browsers print a canvas of WebGL as it was on the
   * screen, so for paper all of it is on the canvas of the words.
   */
  #print(on) {
    const root = document.documentElement;
    if (on) {
      this.#printing = !root.classList.contains("on-paper") ? "class" : "page";
      root.classList.add("on-paper");
    } else {
      if (this.#printing === "class") root.classList.remove("on-paper");
      this.#printing = false;
    }
    this.#recolour();
    this.#drawNow(true);
    if (on) this.#overlay.under(this.#parts.canvas);
  }

  #at(event) {
    const box = this.#parts.stage.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  #pressed(event) {
    const { stage } = this.#parts;
    stage.focus({ preventScroll: true });
    // A middle button would scroll the page.
    if (event.button === 1) event.preventDefault();
    const [x, y] = this.#at(event);
    this.#pointers.set(event.pointerId, { x, y });
    try {
      stage.setPointerCapture(event.pointerId);
    } catch {
      // The pointer has gone meanwhile.
    }
    const pans = event.button !== 0 || event.shiftKey;
    this.#press = this.#pointers.size === 1 ? { x, y, pans, still: true } : null;
  }

  #moved(event) {
    const [x, y] = this.#at(event);
    const before = this.#pointers.get(event.pointerId);
    if (!before) {
      if (event.pointerType !== "touch") this.#mark(this.#pick(x, y));
      return;
    }
    const press = this.#press;
    if (press?.still && Math.hypot(x - press.x, y - press.y) < CLICK_PX) return;
    const pair = this.#pair();
    this.#pointers.set(event.pointerId, { x, y });
    if (press) {
      press.still = false;
      if (press.pans) this.#viewer.pan(x - before.x, y - before.y);
      else this.#viewer.turn((x - before.x) * DRAG_TURN, (y - before.y) * DRAG_TURN);
    } else if (pair) {
      const now = this.#pair();
      this.#viewer.pan(now.x - pair.x, now.y - pair.y);
      this.#viewer.zoom(pair.apart / Math.max(now.apart, 1), this.#viewer.under(now.x, now.y), this.#zoomLimits());
    }
    this.#mark(null);
    this.#steered();
  }

  /** Middle and distance of two fingers. */
  #pair() {
    if (this.#pointers.size !== 2) return null;
    const [a, b] = this.#pointers.values();
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
  }

  #released(event) {
    const press = this.#press;
    this.#pointers.delete(event.pointerId);
    // After a pinch the finger that stays does nothing until it is lifted, so that the view does not jump.
    this.#press = null;
    if (event.type === "pointerup" && press?.still && event.button === 0) this.#clicked(press);
  }

  #clicked({ x, y }) {
    const now = performance.now();
    const last = this.#lastClick;
    const double = last && now - last.at < DOUBLE_CLICK_MS && Math.hypot(x - last.x, y - last.y) < 4 * CLICK_PX;
    this.#lastClick = double ? null : { x, y, at: now };
    const picked = this.#pick(x, y);
    this.#mark(picked);
    if (!double) return;
    if (picked === null) {
      this.reset();
      return;
    }
    this.#viewer.pivot = this.#place(picked);
    this.#steered();
  }

  #wheeled(event) {
    event.preventDefault();
    const [x, y] = this.#at(event);
    const lines = event.deltaMode === 0 ? 1 : 30;
    // Pinching on a touch pad comes as small steps of a wheel with ctrl.
    const by = event.deltaY * lines * (event.ctrlKey ? 0.01 : 0.0015);
    const picked = this.#pick(x, y);
    const about = picked === null ? this.#viewer.under(x, y) : this.#place(picked);
    this.#viewer.zoom(Math.exp(Math.max(-0.5, Math.min(0.5, by))), about, this.#zoomLimits());
    this.#steered();
  }

  #keyed(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target !== this.#parts.stage) return;
    const viewer = this.#viewer;
    const [right, down] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] ?? [0, 0];
    const zoom = { "+": KEY_ZOOM, "=": KEY_ZOOM, "-": 1 / KEY_ZOOM, _: 1 / KEY_ZOOM }[event.key];
    if (right || down) {
      const step = KEY_PAN * viewer.height;
      if (event.shiftKey) viewer.pan(right * step, down * step);
      // Up looks from higher above.
      else viewer.turn(right * KEY_TURN, -down * KEY_TURN);
    } else if (zoom) {
      viewer.zoom(zoom, viewer.pivot, this.#zoomLimits());
    } else if (event.key === "Home" || event.key === "0") {
      this.reset();
    } else {
      return;
    }
    event.preventDefault();
    if (event.key === "Home" || event.key === "0") this.#say("Reset.");
    else {
      this.#steered();
      this.#say(this.#whence());
    }
  }

  #steered() {
    this.#touched = this.#moving = true;
    clearTimeout(this.#rest);
    this.#rest = setTimeout(() => {
      this.#moving = false;
      if (this.#coarse) this.#changed();
    }, REST_MS);
    this.#changed();
  }

  #say(text) {
    this.#parts.told.textContent = text;
  }

  /** From where it is seen, in words. */
  #whence() {
    const { left, above, distance } = this.pose();
    const side = `${Math.abs(left).toFixed(0)}° to the ${left < 0 ? "right" : "left"}`;
    return `Seen from ${side} and ${Math.abs(above).toFixed(0)}° ${above < 0 ? "below" : "above"}, ${distance.toFixed(0)} mm away.`;
  }
}

export { CloudView };
