// How good the calibration is: the verdict, what each number was before and is now, what it assumes.

import { el, keyed, say, set, show, text } from "./dom.js";
import { withRole } from "./session.js";
import { plural, plusMinus, sentence } from "./words.js";

const SIGMA = "One standard deviation: in two of three cases the true value lies no further away";
/** What the figures are, for whoever has not met them. */
const EXPLAINED = {
  "camera focal length": "How strongly the camera magnifies: the wider its view, the shorter",
  "projector focal length": "How strongly the projector magnifies: the wider its picture, the shorter",
  baseline: "The distance between camera and projector",
};

const STATUS = { assumed: "assumed", tested: "tested", estimated: "estimated" };

function rowOf() {
  const name = el("th", { scope: "row" });
  const before = el("td", { class: "before" });
  const now = el("td", { class: "now" });
  return {
    root: el("tr", { "data-state": "figure" }, name, before, now),
    draw(f) {
      set(name.parentNode, "data-name", f.name);
      text(name, f.unit ? `${f.name}, ${f.unit}` : f.name);
      set(name, "title", EXPLAINED[f.name]);
      text(before, f.before ? plusMinus(f.before.value, f.before.sigma) : "");
      text(now, plusMinus(f.value, f.sigma));
    },
  };
}

function assumptionOf() {
  const status = el("span", { class: "chip" });
  const words = el("span");
  const cost = el("small");
  const check = el("small");
  return {
    root: el("li", { "data-state": "assumption" }, status, " ", words, cost, check),
    draw(a) {
      set(status.parentNode, "data-value", a.status);
      set(status.parentNode, "data-name", a.name);
      text(status, STATUS[a.status] ?? a.status);
      text(words, sentence(a.text));
      say(cost, sentence(a.cost));
      say(check, a.check && a.status === "assumed" ? sentence(`to check: ${a.check}`) : "");
    },
  };
}

function warningOf() {
  const message = el("strong");
  const advice = el("span");
  return {
    root: el("li", { "data-state": "warning" }, message, " ", advice),
    draw(w) {
      set(message.parentNode, "data-value", w.code);
      text(message, sentence(w.message));
      text(advice, sentence(w.advice));
    },
  };
}

export function createVerdict(app) {
  const word = el("span", { class: "word" });
  const what = el("span", { class: "what" });
  const cause = el("p");
  const advice = el("p", { class: "hint" });
  const body = el("tbody");
  const beforeHead = el("th", { scope: "col", class: "before" }, "before");
  const table = el("table", {}, el("thead", {}, el("tr", {}, el("td"), beforeHead, el("th", { scope: "col", class: "now" }, "now, ± one ", el("abbr", { title: SIGMA }, "σ")))), body);
  const warnings = el("ul", { class: "warnings" });
  const assumptions = el("ul", { class: "assumptions" });
  const count = el("summary");
  const details = el("details", {}, count, assumptions);
  const report = el("a", { target: "_blank", "data-action": "report" }, "The whole report");
  const root = el("section", { class: "part verdict", "data-state": "verdict" },
    el("h3", {}, what, word), cause, advice, table, warnings, details, el("p", {}, report));
  const drawFigures = keyed(body, (f) => f.name, rowOf);
  const drawWarnings = keyed(warnings, (w) => `${w.code} ${w.message}`, warningOf);
  const drawAssumptions = keyed(assumptions, (a) => a.name, assumptionOf);
  return {
    root,
    draw({ calibration: c, guide }) {
      show(root, Boolean(c));
      set(root, "data-value", c?.verdict);
      if (!c) return;
      text(what, `Calibration from ${plural(c.photographs, "photograph")}: `);
      text(word, c.verdict);
      say(cause, sentence(c.cause));
      // The pose that is asked for says the same, more exactly.
      say(advice, guide?.needed ? "" : sentence(c.advice));
      drawFigures(c.figures);
      set(table, "data-before", c.figures.some((f) => f.before));
      // The worst warning is the cause: it stands above already, as does the advice that several share.
      drawWarnings((c.warnings ?? []).filter((w) => w.message !== c.cause).map((w) => (w.advice === c.advice ? { ...w, advice: "" } : w)));
      drawAssumptions(c.assumptions ?? []);
      const tested = (c.assumptions ?? []).filter((a) => a.status !== "assumed").length;
      const total = (c.assumptions ?? []).length;
      text(count, `What this assumes (${tested} of ${total} tested)`);
      show(details, total > 0);
      show(report.parentNode, Boolean(c.report));
      if (c.report) set(report, "href", withRole(c.report, app.role));
    },
  };
}
