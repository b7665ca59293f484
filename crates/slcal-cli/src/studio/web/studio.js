// The operator's page: puts the parts together, gives each message to all of them.

import { Frames } from "./camera_frames.js";
import { Webcam } from "./camera_webcam.js";
import { createCalibrate } from "./calibrate.js";
import { createCloud } from "./cloud.js";
import { createCommandLine } from "./command_line.js";
import { createDemoScene } from "./demo_scene.js";
import { DisplayWindow } from "./display_window.js";
import { el, set, show, text } from "./dom.js";
import { createDrop } from "./drop.js";
import { createGuidance } from "./guidance.js";
import { createNotices } from "./notices.js";
import { createLink, createPeople } from "./people.js";
import { createPicture } from "./picture.js";
import { createScan } from "./scan.js";
import { enter } from "./session.js";
import { createSetUp } from "./set_up.js";
import { Socket } from "./socket.js";
import { createSteps } from "./steps.js";
import { testPicture } from "./test_picture.js";
import { sendPhotograph, sendPicture } from "./upload.js";
import { createUse } from "./use.js";

const TITLES = { "set-up": "Set up", calibrate: "Calibrate", scan: "Scan", use: "Use" };

// A new address in the same tab, as after the studio was started anew, is not loaded by itself.
addEventListener("hashchange", () => location.hash && location.reload());

async function start() {
  let role;
  try {
    role = await enter(["operator", "watcher"]);
  } catch (problem) {
    return turnedAway(problem);
  }
  build(role);
}

function turnedAway(problem) {
  document.getElementById("page").replaceChildren(el("main", { class: "away", "data-state": "no-session", "data-value": problem.code },
    el("h1", {}, "slcal studio"), el("p", { class: "sentence" }, problem.message), el("p", { class: "next" }, problem.advice)));
}

function build(role) {
  const video = el("video", { muted: true, playsinline: true, "aria-label": "Live picture of the webcam" });
  const display = new DisplayWindow();
  let pickedCloud = null;

  const app = {
    role,
    state: null,
    live: null,
    operating: () => Boolean(app.state?.you.operating),
    connected: () => socket.up,
    /** How near the sheet of a live frame is to the present outline; null where that was not looked at. */
    near: (live) => (live && live.outline === outline ? live.near ?? null : null),
    here: () => ({ webcam: webcam.running, near: app.near(app.live), turned: scene.turned(app.state?.guide ?? null) }),
    // Who only looks on changes nothing.
    send: (event) => (app.operating() || event.event === "take-over") && socket.send(event),
    problem: (name, problem) => notices.problem(name, problem),
    forget: (name) => notices.forget(name),
    note: (message, advice) => notices.note(message, advice),
    /** Where the focus goes when what had it is gone. */
    focus: () => guidance.focus() || steps.focus(),
    look: (id) => picture.photograph(picture.chosen === id ? null : id),
    looking: () => picture.chosen,
    pickedCloud: () => pickedCloud ?? app.state?.scan.clouds.at(-1)?.id,
    pickCloud(id) {
      pickedCloud = id;
      app.redraw();
    },
    redraw: () => app.state && draw(app.state),
    webcamList: () => Webcam.list(),
    async chooseCamera(kind) {
      app.problem("webcam", null);
      if (kind === "webcam") return app.startWebcam();
      release();
      cameraTold = "";
      app.send({ event: "camera", kind });
    },
    async startWebcam(device = null) {
      app.problem("webcam", null);
      if (app.state?.set_up.camera !== "webcam") tellCamera(null, []);
      try {
        await webcam.start(device);
        frames.start();
      } catch (problem) {
        lost(problem);
      }
      app.redraw();
    },
    stopWebcam() {
      release();
      tellCamera(null, []);
    },
  };

  const webcam = new Webcam(video, {
    onChange: () => {
      tellCamera(webcam.size, webcam.held);
      app.redraw();
    },
    onLost: (problem) => lost(problem),
  });
  app.webcam = webcam;

  // A browser tells the same size more than once; the studio need not.
  let cameraTold = "";
  function tellCamera(size, held) {
    const event = { event: "camera", kind: "webcam", size, held };
    const written = JSON.stringify(event);
    if (written !== cameraTold && app.send(event)) cameraTold = written;
  }

  /** The studio must know, too, so that it does not wait for a photograph. */
  function lost(problem) {
    release();
    cameraTold = "";
    app.send({ event: "camera-lost", message: problem.message.replace(/\.$/, "") });
    app.problem("webcam", problem);
  }

  function release() {
    webcam.stop();
    frames.stop();
    app.live = null;
    picture.forget();
    app.redraw();
  }

  let forgetDisplay = null; // takes away the words that say how to get to full screen
  async function openDisplay() {
    const { links, set_up: settings, demo } = app.state;
    try {
      const words = await display.show({ link: links?.display, panel: settings.projector, demo });
      app.problem("display-window", null);
      if (words) forgetDisplay = app.note(words);
    } catch (problem) {
      app.problem("display-window", problem);
    }
  }

  async function project(blob, name) {
    app.problem("picture", null);
    try {
      await sendPicture(role, blob, name, { page: app.state.you.page }); // It is shown as soon as it is drawn.
    } catch (problem) {
      app.problem("picture", problem);
    }
  }

  const step = (name) => () => app.send({ event: "step", step: name });
  const scanning = (mode) => () => {
    pickedCloud = null;
    app.send({ event: "scan", mode });
  };
  const drop = createDrop(app);
  const guidance = createGuidance(app, {
    "open-display": openDisplay,
    "use-measured": () => app.send({ event: "set-up", projector: app.state.display.measured.viewport, size: app.state.set_up.size }),
    "start-webcam": () => app.startWebcam(),
    "go-calibrate": step("calibrate"),
    "turn-for-me": () => scene.turnTo(app.state.guide),
    take: () => app.send({ event: "take" }),
    "choose-files": () => drop.choose(),
    "go-scan": step("scan"),
    "scan-once": scanning("once"),
    "scan-start": scanning("start"),
    "scan-stop": scanning("stop"),
    "go-use": step("use"),
    "test-picture": async () => project(await testPicture(), "test picture.png"),
    "choose-picture": () => drop.choosePicture(),
    "show-picture": () => app.send({ event: "show", kind: "picture" }),
    "show-black": () => app.send({ event: "show", kind: "black" }),
  });

  const notices = createNotices(app);
  const people = createPeople(app);
  const link = createLink();
  const steps = createSteps(app);
  const picture = createPicture(app, video);
  const scene = createDemoScene(app, picture.frame);
  const cloud = createCloud(app);
  const command = createCommandLine();
  const slot = el("div", { class: "scene-slot" });
  const panels = {
    "set-up": createSetUp(app),
    calibrate: createCalibrate(app),
    scan: createScan(app),
    use: createUse(app),
  };
  const title = el("h2", { class: "out-of-sight" });
  const panel = el("div", { class: "panel" }, title, ...Object.values(panels).map((p) => p.root), slot);
  slot.append(scene.root);
  const page = document.getElementById("page");
  const main = el("main", {}, picture.root, cloud.root, guidance.root, panel);
  page.replaceChildren(
    el("header", {}, el("h1", {}, "slcal studio"), steps.root, people.count),
    el("div", { class: "messages" }, link.root, people.root, notices.root),
    main, command.root, ...drop.nodes);

  function draw(state) {
    if (page.dataset.step !== state.step) {
      main.scrollTop = 0;
      notices.forget("file-"); // They belong to the step before.
    }
    set(page, "data-step", state.step);
    set(page, "data-operating", String(state.you.operating));
    document.title = `${TITLES[state.step]} · slcal studio`;
    text(title, TITLES[state.step]);
    for (const [name, part] of Object.entries(panels)) show(part.root, name === state.step);
    show(slot, state.step !== "set-up");
    show(cloud.root, state.step === "scan");
    for (const part of [people, steps, guidance, picture, scene, command]) part.draw(state);
    panels[state.step].draw(state);
    if (state.step === "scan") cloud.draw(state, pickedCloud);
    notices.draw();
  }

  let autoStarted = false;
  let outline = ""; // where the sheet should come, as it is written
  let late = false; // the next live frame may have been on its way before the outline changed
  const socket = new Socket(role, {
    link(l) {
      link.link(l);
      // Nothing that is pressed now would arrive.
      set(page, "data-link", l.up ? null : "lost");
      // The studio forgets the webcam of a page that is gone.
      if (!l.up) cameraTold = "";
      app.redraw();
    },
    state({ state }) {
      const before = app.state;
      app.state = state;
      const wanted = String(state.guide?.quad ?? "");
      if (wanted !== outline) [outline, late] = [wanted, true];
      if (before && before.camera.kind !== state.camera.kind) app.live = null;
      if (state.display.connected && state.display.measured?.fullscreen) {
        forgetDisplay?.();
        forgetDisplay = null;
      }
      // Somebody else operates now: the camera belongs to that page.
      if (before?.you.operating && !state.you.operating && webcam.running) {
        release();
        cameraTold = "";
      }
      if (!state.you.operating) autoStarted = false;
      else if (webcam.running && cameraTold === "" && state.camera.kind === "webcam") tellCamera(webcam.size, webcam.held);
      // After a reload and after somebody else has operated, where the browser need not ask again.
      if (!autoStarted && state.you.operating && state.set_up.camera === "webcam" && !webcam.running) {
        autoStarted = true;
        Webcam.allowed().then((yes) => yes && app.startWebcam());
      }
      // The light changes when the checkerboard comes up: what was held before is of no use.
      if (before && before.display.wanted?.kind !== "checker" && state.display.wanted?.kind === "checker" && state.photographs.length === 0) {
        if (webcam.running) webcam.hold();
      }
      frames.longest = state.camera.live_longest_px ?? frames.longest;
      draw(state);
    },
    live({ live }) {
      live.outline = late ? null : outline;
      late = false;
      app.live = live;
      frames.answered(live.seq);
      picture.live(live);
      guidance.live();
    },
    async shoot({ shot }) {
      if (!webcam.running) return;
      try {
        const { blob, name } = await webcam.grab();
        await sendPhotograph(role, blob, name, { page: app.state.you.page, shot });
      } catch (problem) {
        app.problem("shot", problem);
      }
    },
    refused: ({ message, problem }) => notices.refused(problem ?? { code: "refused", message }),
  });
  const frames = new Frames(video, socket);

  addEventListener("keydown", (event) => {
    if (event.code !== "Space" || event.repeat || event.ctrlKey || event.altKey || event.metaKey) return;
    const free = document.activeElement === document.body || document.activeElement === picture.frame || document.activeElement === null;
    if (free && guidance.shoot()) event.preventDefault();
  });
}

start();
