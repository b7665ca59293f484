// What is wrong and what to do about it: problems of the server's state, of this page, and events that were refused.

import { button, el, keyed, set, text } from "./dom.js";
import { sentence } from "./words.js";

const NOTE_MS = 8000;
/** Codes of settings that the studio refused begin so. */
const OF_SETTINGS = "set-up";

export function createNotices(app) {
  const root = el("div", { class: "notices", role: "region", "aria-label": "Problems", "aria-live": "assertive" });
  const own = new Map(); // name: {problem, kind, always}
  let next = 0;
  let settingsWrong = false;

  const make = () => {
    const message = el("strong");
    const advice = el("span");
    const close = button("dismiss", "Close", () => part.close(), { class: "small" });
    const node = el("div", { class: "notice", "data-state": "problem" }, el("p", {}, message, " ", advice), close);
    const part = {
      root: node,
      close: () => {},
      draw(item) {
        set(node, "data-value", item.code);
        set(node, "data-kind", item.kind);
        text(message, sentence(item.message));
        text(advice, sentence(item.advice));
        close.hidden = !item.close;
        part.close = item.close ?? (() => {});
      },
    };
    return part;
  };
  const drawAll = keyed(root, (item) => item.key, make);

  const draw = () => {
    const state = app.state;
    const items = [];
    const seen = new Set();
    const put = (key, problem, close, kind = "problem", always = false) => {
      const words = sentence(problem?.message);
      // What stands above the buttons already is not said twice, unless it answers what was just pressed.
      if (!problem || seen.has(words) || (words === state?.sentence && !always)) return;
      seen.add(words);
      // Written out: the message of an Error is not copied by a spread.
      items.push({ key, kind, message: problem.message, advice: problem.advice, code: problem.code, close });
    };
    if (state) {
      put("state", state.problem, state.you.operating ? () => app.send({ event: "dismiss" }) : null);
      // A display that is not there yet is no fault: the button that opens it stands in view.
      if (state.display.problem?.code !== "display-missing") put("display", state.display.problem);
      // This page knows better what its own webcam lacks.
      if (!own.has("webcam")) put("camera", state.camera.problem);
    }
    for (const [key, { problem, kind, always }] of own) {
      put(key, problem, () => {
        own.delete(key);
        draw();
      }, kind, always);
    }
    const focused = [...root.children].findIndex((node) => node.contains(document.activeElement));
    drawAll(items);
    if (focused >= 0 && !root.contains(document.activeElement)) keepFocus(focused);
  };

  /** The focus was in a notice that is gone: left to the page's body, the space key would take a photograph. */
  function keepFocus(place) {
    const closes = [...root.querySelectorAll("button")].filter((b) => !b.hidden);
    const b = closes[Math.min(place, closes.length - 1)];
    if (b) b.focus({ preventScroll: true });
    else app.focus();
  }

  /** Takes away the problems of this page whose name, or whose code, begins so. */
  function forget({ name, code }) {
    for (const [key, { problem }] of own) {
      if ((name && key.startsWith(name)) || (code && problem.code?.startsWith(code))) own.delete(key);
    }
  }

  /** Something that goes by itself, or earlier by the function that is returned. */
  function passing(kind, problem) {
    const key = `passing-${next++}`;
    own.set(key, { problem, kind, always: true });
    draw();
    const end = () => own.delete(key) && draw();
    setTimeout(end, NOTE_MS);
    return end;
  }

  return {
    root,
    draw() {
      // Settings that are right now: what was said of wrong ones is settled.
      const wrong = Boolean(app.state?.set_up.problem);
      if (settingsWrong && !wrong) forget({ code: OF_SETTINGS });
      settingsWrong = wrong;
      draw();
    },
    /** A problem of this page under a name; null takes it away. */
    problem(name, problem) {
      if (problem) own.set(name, { problem, kind: "problem" });
      else own.delete(name);
      draw();
    },
    /** All problems of this page whose names begin so are mended, or of yesterday. */
    forget(name) {
      forget({ name });
      draw();
    },
    note: (message, advice = "") => passing("note", { code: "note", message, advice }),
    /** An event that the studio did not accept. Wrong settings are told at their field, where that is in view. */
    refused(problem) {
      if (!(app.state?.step === "set-up" && problem.code?.startsWith(OF_SETTINGS))) passing("problem", problem);
    },
  };
}
