// Which button is the one to press now, and which others stand beside it. Nothing but a decision: no element is touched.

import { NEAR } from "./overlay.js";

/** Two photographs are the normal path. */
const ENOUGH_PHOTOGRAPHS = 2;

const stepState = (state, step) => state.steps.find((s) => s.step === step)?.state;
const open = (state, step) => stepState(state, step) !== "locked";

/** The webcam belongs to the page that operates, and does not run: never started, stopped, or taken away. */
const webcamMissing = (state, here) => state.camera.kind === "webcam" && !here.webcam;
/** Nothing is shown: the display window is not open, or it says what is wrong with it. */
const displayMissing = (state) => !state.display.connected || Boolean(state.display.problem);
/** The studio takes no photograph: the simulated camera would see nothing, a webcam a picture that is scaled. */
const blind = (state) => displayMissing(state) && (state.demo || state.display.connected);

function setUp(state, here) {
  const { set_up: settings, display } = state;
  const measured = display.measured?.fullscreen ? display.measured.viewport : null;
  const others = [];
  let first = null;
  const put = (action) => (first === null ? (first = action) : others.push(action));
  if (displayMissing(state)) put("open-display");
  if (!settings.projector && measured) put("use-measured");
  if (webcamMissing(state, here)) put("start-webcam");
  // Without the display window the simulated camera has nothing to see.
  if (open(state, "calibrate") && (display.connected || !state.demo)) put("go-calibrate");
  if (display.connected && first !== "open-display") others.push("open-display");
  return { first, others };
}

function calibrate(state, here) {
  const used = state.photographs.filter((p) => p.used && !p.problem).length;
  const enough = used >= ENOUGH_PHOTOGRAPHS && state.calibration && !state.guide?.needed;
  const shoot = { files: "choose-files", phone: null, folder: null }[state.camera.kind];
  const take = shoot !== undefined ? shoot : blind(state) ? null : "take";
  const turnable = state.demo_scene && !blind(state) && state.guide?.turn && !here.turned && !(here.near >= NEAR) ? "turn-for-me" : null;
  const open_display = displayMissing(state) ? "open-display" : null;
  const go = open(state, "scan") ? "go-scan" : null;
  const start = webcamMissing(state, here) ? "start-webcam" : null;
  if (enough) return { first: go, others: [start ?? take, turnable, open_display] };
  const order = [open_display, start, turnable, start ? null : take].filter(Boolean);
  return { first: order[0] ?? null, others: [...order.slice(1), go] };
}

function scan(state, here) {
  const byHand = ["phone", "folder"].includes(state.camera.kind);
  if (state.scan.shots) {
    return { first: state.scan.shots.by_hand && state.scan.shots.shown && state.camera.kind === "files" ? "choose-files" : "scan-stop", others: ["scan-stop"] };
  }
  const many = state.scan.method !== "stripes";
  const once = many ? (displayMissing(state) ? null : "scan-once")
    : state.camera.kind === "files" ? "choose-files" : byHand || blind(state) ? null : "scan-once";
  const go = open(state, "use") && state.scan.clouds.length > 0 ? "go-use" : null;
  if (displayMissing(state) && (!byHand || many)) return { first: "open-display", others: [state.scan.continuous ? "scan-stop" : once, go] };
  if (webcamMissing(state, here)) return { first: "start-webcam", others: [go] };
  if (state.scan.continuous) return { first: "scan-stop", others: [go] };
  return { first: once, others: [many || byHand || state.camera.kind === "files" ? null : "scan-start", go] };
}

function use(state) {
  if (displayMissing(state)) return { first: "open-display", others: ["choose-picture", state.display.wanted?.kind === "picture" ? "show-black" : null] };
  if (!state.use.picture) return { first: "test-picture", others: ["choose-picture"] };
  if (state.display.wanted?.kind === "picture") return { first: "choose-picture", others: ["show-black"] };
  return { first: "show-picture", others: ["choose-picture", "test-picture"] };
}

const STEPS = { "set-up": setUp, calibrate, scan, use };

/** `here` is what only this page knows: whether its webcam runs, how near the sheet is to the dashed outline, whether it was turned there. */
export function choose(state, here) {
  if (!state.you.operating) return { first: null, others: [] };
  const { first, others } = STEPS[state.step](state, here);
  return { first, others: others.filter((action) => action && action !== first) };
}
