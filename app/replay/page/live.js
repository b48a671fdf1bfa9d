/* The player of a live view: frames come from the server that runs the simulation (`projdyn view`), and what is done
 * on the page goes there. The messages are described in app/view/actions.c and app/view/frame.h. */
const framesLimit = 1 << 28; /* bytes of frames; beyond it, every other one is forgotten */
const rowsLimit = 4000; /* rows of the plots; the same */
const everyOther = (list) => list.filter((_, k) => k % 2 === (list.length - 1) % 2); /* the last one stays */

/* Lists of a part that have one entry for each frame. */
const frameLists = (part) => [part.x, part.points, part.boxes, part.mosts, ...part.channels.map((name) => part[name])];
const movingParts = () => allParts().filter((part) => !part.rest);

/* A typed array of a message, and the position behind it: arrays are padded to a multiple of 4 bytes. */
function takeArray(message, Type, count) {
  const out = new Type(message.buffer, message.at, count);
  message.at += 4 * Math.ceil(out.byteLength / 4);
  return out;
}

/* Appends the frame of a message to the parts. */
function appendFrame(message, head) {
  meta.times.push(head.time);
  movingParts().forEach((part, k) => {
    const { points, box, most } = head.parts[k];
    part.x.push(takeArray(message, Uint16Array, 3 * points));
    part.points.push(points);
    part.boxes.push(box);
    part.mosts.push(Object.fromEntries(part.channels.map((name, c) => [name, most[c]])));
    for (const name of part.channels) part[name].push(takeArray(message, Uint8Array, points));
  });
}

/* Head and numbers of a message (app/view/frame.h). */
function readMessage(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  return [head, { buffer, at: 4 + length }];
}

/* The smallest of 1, 2, 5, 10, 20, ... times a power of ten that is at least `size`. */
function roundUp(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  return [1, 2, 5, 10].find((k) => k * power >= size * 0.999) * power;
}

class LivePlayer extends Player {
  constructor() {
    super();
    this.rate = "fast";
    this.pictureTime = 1 / 90; /* without a graphics card, the simulation needs the processor, too */
    this.rates = { step: 0, frame: 0, last: 0, shown: 0 };
    this.bytes = this.drawn = this.undrawn = 0;
  }
  start() {
    for (const part of movingParts()) Object.assign(part, { boxes: [part.box], mosts: [part.most] });
    this.lowest = renderer.groundHeight;
    this.grab = new Grab(renderer, (message) => this.send(message));
    this.notes = element($("view"), "div", { id: "notes" });
    this.connect();
  }
  connect() {
    const url = new URL("live", location.href.replace(/^http/, "ws"));
    url.search = location.search;
    this.socket = Object.assign(new WebSocket(url, "live"), { binaryType: "arraybuffer" });
    this.socket.onopen = () => {
      this.send({ do: "hello" });
      this.send({ do: "ready" });
    };
    this.socket.onmessage = (e) => this.receive(e.data);
    this.socket.onclose = (e) => {
      document.body.classList.add("ended");
      this.playing = false;
      this.showIcon();
      this.note(`The view has ended${e.reason ? ": " + e.reason : ""}. This is its last state.`, true);
    };
  }
  send(message) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /* ---- frames ---------------------------------------------------------------------------------------------- */

  receive(buffer) {
    const [head, message] = readMessage(buffer), following = this.following();
    const again = this.starts !== undefined && head.starts !== this.starts || head.time < meta.times[lastFrame()];
    if (again) this.forget();
    else if (head.time === meta.times[lastFrame()]) this.dropLast();
    this.starts = head.starts;
    appendFrame(message, head);
    this.appendRow(head.row);
    this.bytes += buffer.byteLength;
    if (this.bytes > framesLimit) this.thin();
    this.adapt();
    this.showState(head, again);
    if (following || again) this.show(lastFrame());
    else this.refresh();
    this.drawPlots(head.running && !again);
    this.acknowledge();
  }
  /* Asks for the next frame when at most one is not drawn: it comes while that one is drawn. */
  acknowledge() {
    if (++this.undrawn < 2) this.send({ do: "ready" });
    requestAnimationFrame(() => { /* after the picture */
      if (this.undrawn > 1) this.send({ do: "ready" });
      this.undrawn = 0;
    });
  }
  following() {
    return this.frame >= lastFrame();
  }
  forget() {
    meta.times.length = this.bytes = 0;
    for (const part of movingParts()) for (const list of frameLists(part)) list.length = 0;
    for (const name in meta.metrics) meta.metrics[name] = [];
    for (const name in ranges) ranges[name] = { top: 1e-6, most: 0 };
    this.lowest = renderer.groundHeight;
  }
  dropLast() {
    meta.times.pop();
    for (const part of movingParts()) for (const list of frameLists(part)) list.pop();
  }
  /* Forgets every other frame, so that the rest of the whole run stays. */
  thin() {
    const keep = (list) => list.splice(0, Infinity, ...everyOther(list)), time = meta.times[this.frame];
    keep(meta.times);
    for (const part of movingParts()) for (const list of frameLists(part)) keep(list);
    this.bytes /= 2;
    this.frame = nearestFrame(time);
  }
  appendRow(row) {
    const columns = meta.metrics, times = columns.time_s;
    if (!row || row.time_s <= times[times.length - 1]) return;
    for (const name in columns) columns[name].push(row[name]);
    if (times.length > rowsLimit) for (const name in columns) columns[name] = everyOther(columns[name]);
  }
  /* What depends on all frames of a replay: ends of the colour maps, the height of the ground. */
  adapt() {
    const last = lastFrame(), lowest = Math.min(...movingParts().map((part) => part.points[last] ? part.boxes[last][0][vertical] : Infinity));
    this.lowest = Math.min(this.lowest, lowest);
    renderer.backdrop.place(this.lowest - 0.002 * renderer.camera.radius);
    for (const name of new Set([fluidChannel(), settings.surface])) {
      if (!ranges[name]) continue;
      const bodies = meta.bodies.filter((body) => name in body.most);
      const { top, most } = name === "stretch" ? measureStretch(renderer.parts, [last]) : measureChannel(bodies, name, [last]);
      if (most > ranges[name].most) ranges[name].most = most;
      if (top <= ranges[name].top) continue;
      ranges[name].top = roundUp(top);
      showLegends();
    }
    renderer.stale = true;
  }

  /* ---- the page -------------------------------------------------------------------------------------------- */

  showState(head, again) {
    this.playing = head.running;
    this.showIcon();
    $("rate").value = this.rate = head.real_time ? "real" : "fast";
    $("scrub").max = lastFrame();
    document.body.classList.toggle("failed-step", head.failed);
    if (head.warnings) {
      meta.warnings = head.warnings;
      listWarnings();
    }
    if (head.parameters) this.controls.showParameters(head.parameters);
    if (head.gravity) this.controls.showGravity(head.gravity);
    if (again) this.notes.replaceChildren();
    for (const { text, bad } of head.notes) this.note(text, bad);
    this.showRates(head);
  }
  /* seldom: four times a second at most */
  drawPlots(seldom) {
    const now = performance.now();
    if (seldom && now - this.drawn < 250) return;
    this.drawn = now;
    for (const plot of this.plots) {
      plot.read();
      plot.draw();
    }
  }
  /* Times, as running means, four times a second. */
  showRates({ step_ms: step, running }) {
    const rates = this.rates, now = performance.now(), mean = (before, value) => before ? 0.85 * before + 0.15 * value : value;
    if (rates.last) rates.frame = mean(rates.frame, now - rates.last);
    rates.step = mean(rates.step, step);
    rates.last = running ? now : 0;
    if (running && now - rates.shown < 250) return;
    rates.shown = now;
    $("rates").textContent = `step ${formatNumber(rates.step)} ms` + (running && rates.frame
      ? `  ·  frame ${formatNumber(rates.frame)} ms, ${formatNumber(1000 / rates.frame)} a second` : "");
  }
  note(text, bad) {
    const note = element(this.notes, "div", { textContent: text, className: bad ? "bad" : "" });
    element(note, "button", { textContent: "×", title: "Close", onclick: () => note.remove() });
    if (bad) this.controls.showKnown();
    else setTimeout(() => note.remove(), 12000);
  }
  refresh() {
    super.refresh();
    this.grab?.show();
    $("now").disabled = this.following();
  }
  /* At the last frame, the plots are drawn less often, see drawPlots(). */
  showPlots() {
    if (!this.following()) super.showPlots();
  }
  frameText() {
    const ago = meta.times[lastFrame()] - meta.times[this.frame];
    return this.following() ? "" : `${formatNumber(ago)} s ago`;
  }

  /* ---- actions --------------------------------------------------------------------------------------------- */

  advance() {}
  open() {}
  play(on) {
    if (on) this.show(lastFrame());
    this.send({ do: on ? "run" : "pause" });
  }
  stepFrames(by) {
    if (by > 0 && this.following()) return this.send({ do: "step" });
    if (this.playing) this.play(false);
    this.show(this.frame + by);
  }
  speeds() {
    return [["fast", "As fast as possible"], ["real", "Real time", "No faster than the clock"]];
  }
  setSpeed(value) {
    this.send({ do: "speed", real_time: value === "real" });
  }
  gestures() {
    return [["drag a sheet or soft body", "pull it"]];
  }
  actions() {
    const [picture, film, , help] = super.actions();
    return [[...picture], ["WebM", "Record a film until the next click", film[2]],
      ["Save", "Save the state; projdyn run --resume continues from it", () => this.send({ do: "save" })], help];
  }
  /* Films until the next click. */
  film(button, stop) {
    const { textContent, onclick } = button;
    button.textContent = "Stop";
    button.onclick = () => {
      Object.assign(button, { textContent, onclick });
      stop();
    };
  }
}

/* Adds to the page what a replay does not have: sliders, buttons, times. */
function buildLive() {
  keys[" "][0] = "run or pause";
  keys.ArrowRight[0] = "one frame on; at the last one: a single step";
  delete keys.l;
  const icon = (path) => `<svg viewBox="0 0 13 13"><path d="${path}"/></svg>`;
  const button = (id, title, path, act) => {
    const e = element($("actions").parentNode, "button", { id, title, innerHTML: icon(path), onclick: act });
    $("track").before(e);
  };
  button("step", "Single step (→)", "M2 .8v11.4L9 6.5zM9.4 1h2v11h-2z", () => player.send({ do: "step" }));
  button("restart", "Start the scene again", "M6.5 2V0L2.8 3.1 6.5 6.2V4a3.6 3.6 0 1 1-3.6 3.6H1A5.5 5.5 0 1 0 6.5 2z",
    () => player.send({ do: "restart" }));
  $("time").before(element(document.body, "button",
    { id: "now", textContent: "Live", title: "Back to the present state (End)", onclick: () => player.show(lastFrame()) }));
  $("about").after(element(document.body, "span", { id: "rates" }));
  player.controls = new Controls($("plots"), (message) => player.send(message));
  document.body.classList.add("live");
}
