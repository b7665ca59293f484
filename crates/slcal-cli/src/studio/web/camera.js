// The phone: one button that takes a photograph with the phone's own camera and sends it, and what came of it.

import { el, keyed, say, set, show, text } from "./dom.js";
import { createLink } from "./people.js";
import { enter } from "./session.js";
import { Socket } from "./socket.js";
import { refusal, sendPhotograph } from "./upload.js";
import { bytes, degrees, sentence as whole } from "./words.js";

addEventListener("hashchange", () => location.hash && location.reload());

async function start() {
  try {
    await enter(["camera"]);
  } catch (problem) {
    document.getElementById("page").replaceChildren(el("main", { class: "away", "data-state": "no-session", "data-value": problem.code },
      el("h1", {}, "slcal studio"), el("p", { class: "sentence" }, problem.message),
      el("p", { class: "next" }, "Point the phone's camera at the code that the studio shows.")));
    return;
  }
  build();
}

function build() {
  let state = null;
  let count = 0;
  const sent = []; // newest first: {key, name, size, status: "sending"|"looking"|"refused", id, problem}

  const sentence = el("p", { class: "sentence", "data-state": "sentence" });
  const next = el("p", { class: "next", "data-state": "next" });
  const input = el("input", { type: "file", accept: "image/*", capture: "environment", id: "shoot", class: "out-of-sight", "data-action": "photograph-file" });
  const label = el("label", { class: "shoot", for: "shoot", "data-state": "shoot" });
  const list = el("ul", { class: "sent" });
  const title = el("h1", { class: "out-of-sight" }, "Photographs for slcal studio");
  const link = createLink();
  document.getElementById("page").replaceChildren(
    el("div", { class: "messages" }, link.root),
    el("main", {}, title, el("div", { "aria-live": "polite" }, sentence, next), input, label,
      el("h2", { class: "out-of-sight" }, "Photographs that were sent"), list));

  const drawAll = keyed(list, (item) => item.key, () => {
    const word = el("strong");
    const more = el("span");
    const advice = el("p", { class: "advice" });
    const root = el("li", { "data-state": "answer" }, el("p", {}, word, " ", more), advice);
    return {
      root,
      draw(item) {
        const answer = answerOf(item);
        set(root, "data-value", answer.value);
        text(word, answer.word);
        text(more, answer.more);
        say(advice, answer.advice);
      },
    };
  });

  function answerOf(item) {
    if (item.status === "sending") return { value: "sending", word: "Sending …", more: `${item.name}, ${bytes(item.size)}` };
    if (item.problem) return { value: "refused", word: "Not sent.", more: whole(item.problem.message), advice: whole(item.problem.advice) };
    const known = item.scan ? null : state?.photographs?.find((p) => p.id === item.id);
    if (item.scan) return { value: "good", word: "Arrived.", more: "The scan is computed on the computer." };
    if (!known) return { value: "looking", word: "Arrived.", more: "The studio is looking at it …" };
    if (known.problem) return { value: "refused", word: "Not used.", more: whole(known.problem.message), advice: whole(known.problem.advice) };
    const tilt = known.tilt_deg ? `, tilt ${known.tilt_deg.map(degrees).join(", ")}` : "";
    const corners = known.of && known.corners !== known.of ? `${known.corners} of ${known.of}` : known.corners;
    return { value: "good", word: "Good.", more: `Sheet and ${corners} corners found${tilt}.` };
  }

  function draw() {
    // In other steps the studio would refuse it; what is to be done there is done on the computer.
    const expected = state?.step === "calibrate" || state?.step === "scan";
    text(sentence, state?.sentence);
    text(next, expected || !state ? state?.next : "The computer is not ready for a photograph yet.");
    const sending = sent.some((item) => item.status === "sending");
    text(label, sending ? "Sending …" : state?.step === "scan" ? "Photograph the object" : "Take a photograph");
    set(label, "data-value", sending ? "sending" : expected ? "ready" : "waiting");
    input.disabled = sending || !expected;
    drawAll(sent);
    show(list, sent.length > 0);
  }

  input.addEventListener("change", async () => {
    const [file] = input.files;
    input.value = "";
    if (!file) return;
    const item = { key: ++count, name: file.name || "photograph", size: file.size, status: "sending" };
    sent.unshift(item);
    draw();
    try {
      const refused = refusal(file, "photograph");
      if (refused) throw refused;
      Object.assign(item, await sendPhotograph("camera", file, file.name || "photograph.jpg"));
      item.status = "looking";
    } catch (problem) {
      item.status = "refused";
      item.problem = problem;
    }
    draw();
  });

  new Socket("camera", {
    link: (l) => link.link(l),
    state(message) {
      state = message.state;
      draw();
    },
  });
  draw();
}

start();
