// What is wrong and what to do about it: problems of the server's state, of this page, and events that were refused.

import { button, el, keyed, set, text } from "./dom.js";
import { sentence } from "./words.js";

const NOTE_MS = 8000;

export function createNotices(app) {
  const root = el("div", { class: "notices", role: "region", "aria-label": "Problems", "aria-live": "assertive" });
  const own = new Map();
  let next = 0;

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
    const put = (key, problem, close, kind = "problem") => {
      const words = sentence(problem?.message);
      // What stands above the buttons already is not said twice.
      if (!problem || seen.has(words) || words === state?.sentence) return;
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
    for (const [key, { problem, kind }] of own) {
      put(key, problem, () => {
        own.delete(key);
        draw();
      }, kind);
    }
    drawAll(items);
  };

  /** Something that goes by itself, or earlier by the function that is returned. */
  function passing(kind, problem) {
    const key = `passing-${next++}`;
    own.set(key, { problem, kind });
    draw();
    const forget = () => own.delete(key) && draw();
    setTimeout(forget, NOTE_MS);
    return forget;
  }

  return {
    root,
    draw,
    /** A problem of this page under a name; null takes it away. */
    problem(name, problem) {
      if (problem) own.set(name, { problem, kind: "problem" });
      else own.delete(name);
      draw();
    },
    note: (message, advice = "") => passing("note", { code: "note", message, advice }),
    /** An event that the studio did not accept. */
    refused: (problem) => passing("problem", problem),
  };
}
