// The page on the projector: shows pixel for pixel what is wanted, or says why it cannot.

import { fetchPicture, paint } from "./display_paint.js";
import { Measure, refusal } from "./display_screen.js";
import { say, set, show, text } from "./dom.js";
import { enter, withRole } from "./session.js";
import { Socket } from "./socket.js";
import { pixels } from "./words.js";

const $ = (id) => document.getElementById(id);
const canvas = $("panel");
const card = $("card");

let socket = null;
let state = null;
let measure = null;
let told = ""; // what was last measured, as it was sent
let shown = null; // sequence that is on the panel
let turn = 0; // counts what is wanted: a picture that loads slowly must not come up after a later one
let loading = null; // sequence that is on its way
let unshowable = null; // the sequence that could not be shown, and why

/** After two animation frames what was painted is on the screen. */
const painted = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
const panelOf = (s) => s.set_up.projector ?? measure.now().viewport;

function problemNow(measured) {
  const ofPicture = unshowable?.sequence === state.display.wanted?.sequence ? unshowable.problem : null;
  if (state.demo) return ofPicture;
  return refusal(state.set_up.projector, measured) ?? ofPicture;
}

/** Device pixels as CSS pixels: the canvas then takes exactly as many pixels of the screen as it has. Whether that changed anything. */
function fit(panel) {
  const before = canvas.style.width + canvas.style.height;
  canvas.style.width = state.demo ? "" : `${panel[0] / devicePixelRatio}px`;
  canvas.style.height = state.demo ? "" : `${panel[1] / devicePixelRatio}px`;
  return canvas.style.width + canvas.style.height !== before;
}

function tell(measured, problem) {
  const { whole, ...figures } = measured;
  const event = { event: "measured", ...figures, problem: state?.demo ? null : problem };
  const written = JSON.stringify(event);
  if (written !== told && socket?.send(event)) told = written;
}

function drawCard(measured, problem) {
  const { demo, display } = state;
  const kind = display.wanted?.kind ?? "black";
  const settingUp = kind === "marks";
  // In full screen nothing but the pattern may be seen, unless one sets up or nothing is shown anyway.
  show(card, demo || problem !== null || settingUp);
  set(card, "data-value", problem ? "refused" : demo ? "demo" : "marks");
  set(card, "data-code", problem?.code);
  const panel = state.set_up.projector;
  if (demo) {
    text($("title"), "The simulated projector");
    const size = panel ? ` ${pixels(panel)} pixels` : "";
    text($("message"), `It throws on the sheet exactly what is painted above:${size}, drawn smaller here.`);
    text($("advice"), "Leave this window open and go back to the studio.");
  } else if (problem?.code === "display-not-full-screen") {
    text($("title"), measured.whole ? "Not quite full screen" : "Press F or double-click for full screen");
    text($("message"), problem.message);
    text($("advice"), problem.advice);
    set(card, "data-value", "window");
  } else if (problem) {
    text($("title"), "Not shown: it would not be pixel for pixel");
    text($("message"), problem.message);
    text($("advice"), problem.advice);
  } else if (measured.fullscreen) {
    text($("title"), "Do you see all four corner marks and the thin frame?");
    text($("message"), "If one is cut off, switch off overscan, zoom and keystone correction at the projector.");
    text($("advice"), window.isSecureContext ? "" : "Switch off the screen saver of this computer: this page may not do so over plain HTTP.");
  } else {
    text($("title"), "Press F or double-click for full screen");
    text($("message"), "Drag this window onto the projector first.");
    text($("advice"), "");
  }
  show($("advice"), $("advice").textContent !== "");
  show($("full-screen"), !demo && !measured.fullscreen);
  say($("facts"), demo ? "" :
    `Screen ${pixels(measured.viewport)} pixels, ${Math.round(measured.device_pixel_ratio * 100)} %${panel ? `; projector ${pixels(panel)}` : ""}`);
}

/** Brings what is wanted onto the panel, as far as nothing speaks against it. */
async function present() {
  if (!state) return;
  const wanted = state.display.wanted;
  const panel = panelOf(state);
  document.body.classList.toggle("demo", state.demo);
  canvas.classList.toggle("demo", state.demo);
  if (fit(panel)) {
    // What it takes now is measured with the next frames; until then nothing is known.
    await painted();
    return present();
  }
  const measured = measure.now();
  document.body.classList.toggle("full", measured.fullscreen && !state.demo);
  const problem = problemNow(measured);
  tell(measured, problem);
  drawCard(measured, problem);
  // Not `hidden`: it must keep the size that is measured.
  canvas.style.visibility = problem?.code === "display-not-full-screen" ? "hidden" : "visible";
  if (problem) {
    if (shown !== null || loading !== null) darken(panel);
    return;
  }
  if (!wanted || wanted.sequence === shown || wanted.sequence === loading) return;

  const mine = ++turn;
  loading = wanted.sequence;
  let picture = null;
  try {
    if (wanted.url) picture = await fetchPicture(wanted.url);
    if (picture && (picture.width !== panel[0] || picture.height !== panel[1])) {
      throw new Error(`it has ${pixels([picture.width, picture.height])} pixels, the projector ${pixels(panel)}`);
    }
  } catch (error) {
    if (mine !== turn) return;
    unshowable = {
      sequence: wanted.sequence,
      problem: {
        code: "display-picture-size",
        message: `The picture cannot be shown: ${error.message}.`,
        advice: "Correct the projector's pixels in Set up, or have the picture shown once more.",
      },
    };
    darken(panel);
    return present();
  }
  if (mine !== turn) return;
  loading = null;
  paint(canvas, panel, wanted.kind, picture);
  shown = wanted.sequence;
  picture?.close();
  if (state.demo) await handBack(wanted.sequence);
  else await painted();
  if (mine === turn) socket.send({ event: "painted", sequence: wanted.sequence });
}

/** Nothing is shown, and what is still on its way does not come up. */
function darken(panel) {
  turn++;
  shown = loading = null;
  paint(canvas, panel, "black");
}

/** The demonstration's camera sees the pixels that were painted here. Also in a window that is hidden: nobody need look at it. */
async function handBack(sequence) {
  const png = await new Promise((done) => canvas.toBlob(done, "image/png"));
  await fetch(withRole("/api/painted", "display", { sequence }), { method: "POST", body: png, credentials: "same-origin" }).catch(() => {});
}

function lost({ up, ended }) {
  set($("lost"), "data-value", up ? "up" : ended ? "ended" : "lost");
  say($("lost"), up ? "" : ended ? "The studio was started anew: open its display window once more." : "No connection to the studio; trying again.");
  told = "";
  if (up) return;
  unshowable = null;
  if (state) darken(panelOf(state));
  show(card, false);
}

function toggleFullScreen() {
  if (state?.demo) return;
  if (document.fullscreenElement) document.exitFullscreen();
  else document.documentElement.requestFullscreen({ navigationUI: "hide" }).catch(() => {});
}

/** The screen must not go dark between two photographs. */
async function stayAwake() {
  if (document.visibilityState !== "visible") return;
  try {
    await navigator.wakeLock?.request("screen");
  } catch {
    // Refused on a low battery; the screen saver is then the user's.
  }
}

async function start() {
  try {
    await enter(["display"]);
  } catch (problem) {
    text($("title"), problem.message);
    text($("message"), problem.advice);
    for (const id of ["advice", "facts", "full-screen"]) show($(id), false);
    set(card, "data-value", "no-session");
    show(card, true);
    return;
  }
  measure = new Measure($("probe"), canvas, () => present());
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
    // Enter on the button presses it already.
    if (event.key.toLowerCase() === "f" || (event.key === "Enter" && document.activeElement !== $("full-screen"))) toggleFullScreen();
  });
  addEventListener("dblclick", (event) => event.target !== $("full-screen") && toggleFullScreen());
  $("full-screen").addEventListener("click", toggleFullScreen);
  document.addEventListener("visibilitychange", stayAwake);
  stayAwake();
  socket = new Socket("display", {
    link: lost,
    state(message) {
      state = message.state;
      present();
    },
  });
  // A second window asked for this one by name: its address had the token once more.
  addEventListener("hashchange", async () => {
    if (!location.hash) return;
    await enter(["display"]).catch(() => {});
    if ($("lost").dataset.value === "ended") location.reload();
  });
}

start();
