/* Start of the page. */
const player = meta.live ? new LivePlayer() : new Player();
let renderer;

function describeRun() {
  const { name, scene, version, threads, integrator, simulated_s: simulated, wall_s: wall } = meta.about;
  $("title").textContent = name || scene || "Replay";
  document.title = `${$("title").textContent} – projdyn ${meta.live ? "view" : "replay"}`;
  const facts = [
    simulated !== undefined && `${formatNumber(simulated)} s simulated`,
    wall !== undefined && `${formatNumber(wall)} s of wall time`,
    threads && `${threads} thread${threads > 1 ? "s" : ""}`,
    !meta.live && `${frameCount()} frame${frameCount() > 1 ? "s" : ""}`, integrator, version && `projdyn ${version}`];
  $("about").textContent = facts.filter(Boolean).join("  ·  ");
}

/* The warnings of the run; each leads to the frame in which it came first, which is marked on the timeline of a
 * replay. */
function listWarnings() {
  const list = meta.warnings || [];
  $("warnings").hidden = !list.length;
  $("warnings").replaceChildren($("warnings").firstElementChild);
  $("warnings").firstElementChild.textContent = `${list.length} warning${list.length > 1 ? "s" : ""}`;
  for (const { code, subject, text, first_s: time } of list) {
    const line = `${subject ? subject + ": " : ""}${text} [${code}]`;
    element($("warnings"), "button", { textContent: line, onclick: () => player.show(nearestFrame(time)) });
    if (time > 0 && frameCount() > 1 && !meta.live)
      element($("track"), "i", { title: line }).style.left = `${100 * nearestFrame(time) / lastFrame()}%`;
  }
}

function buildPlots() {
  const fluid = meta.bodies.some((body) => body.fluid);
  const known = (chart) => meta.live ? fluid || !chart.fluid
    : meta.metrics && chart.lines.some(([column]) => meta.metrics[column].some((v) => v));
  player.plots = charts.filter(known).map((chart) => new Plot($("plots"), chart));
  if (!player.plots.length) document.body.classList.add("plain");
}

const keys = {
  " ": ["play or pause", () => player.play(!player.playing)],
  ArrowLeft: ["one frame back", () => player.stepFrames(-1)],
  ArrowRight: ["one frame on", () => player.stepFrames(1)],
  Home: ["first frame", () => player.show(0)],
  End: ["last frame", () => player.show(lastFrame())],
  r: ["first view", () => { renderer.camera.reset(); player.dirty = true; }],
  v: ["fluid as surface or particles", () => nextChoice("look")],
  c: ["next colour of the fluid", () => nextChoice("fluid")],
  s: ["next colour of surfaces", () => nextChoice("surface")],
  p: ["save a picture", savePicture],
  l: ["copy a link to this view", copyLink],
  "?": ["this help", () => $("help").showModal()],
};

function nextChoice(name) {
  const options = [...(inputs[name]?.options || [])].map((option) => option.value);
  if (options.length) change(name, options[(options.indexOf(settings[name]) + 1) % options.length]);
}

function buildHelp() {
  const names = { " ": "space", ArrowLeft: "←", ArrowRight: "→" }, table = $("help").firstElementChild;
  for (const key in keys) {
    const row = table.insertRow();
    element(row.insertCell(), "kbd", { textContent: names[key] || key });
    row.insertCell().textContent = keys[key][0];
  }
  const gestures = [...player.gestures(), ["drag", "turn"], ["shift or right button and drag", "move"], ["wheel, two fingers", "zoom"]];
  for (const [what, effect] of gestures) {
    const row = table.insertRow();
    row.insertCell().textContent = what;
    row.insertCell().textContent = effect;
  }
}

function controlPlayer() {
  $("scrub").max = lastFrame();
  $("scrub").addEventListener("input", () => player.show(Number($("scrub").value)));
  $("play").addEventListener("click", () => player.play(!player.playing));
  for (const [value, textContent, title = ""] of player.speeds())
    element($("rate"), "option", { value, textContent, title, selected: value === player.rate });
  $("rate").addEventListener("change", () => player.setSpeed($("rate").value));
  for (const [text, title, act] of player.actions())
    element($("actions"), "button", { textContent: text, title, onclick: (e) => act(e.currentTarget) });
  addEventListener("keydown", (e) => {
    if (!keys[e.key] || e.target.matches("select, #controls input") || e.ctrlKey || e.metaKey || e.altKey) return;
    if (e.key === " " && e.target.matches("button, input[type=checkbox], summary")) return; /* the focused control's */
    e.preventDefault();
    keys[e.key][1]();
  });
}

/* Names and what is shown at first: bodies and solids; boundary points only where no solid has a mesh and they
 * move. */
function prepareParts() {
  for (const part of meta.boundary) part.name = part.rest ? "boundary" : "moving boundary";
  for (const part of allParts())
    part.usual = part.shown = !meta.boundary.includes(part) || !part.rest && !meta.solids.length;
  const radius = Math.max(0, ...meta.bodies.map((b) => b.radius));
  for (const part of meta.boundary) part.radius = 0.4 * radius || 0.004 * Math.max(...meta.bodies[0].box[1].map(Math.abs));
}

async function start() {
  if (meta.live) buildLive();
  describeRun();
  listWarnings();
  const gl = $("scene").getContext("webgl2", { antialias: false, alpha: false });
  if (!gl) throw new Error("This page needs WebGL 2, which this browser does not offer. " +
    "Current versions of Firefox and Chromium do, unless graphics are switched off in their settings.");
  if (!window.DecompressionStream)
    throw new Error("This page needs a newer browser: Firefox from 113, Chromium from 80.");
  unpack(await inflate($("data").textContent));
  $("data").remove();
  prepareParts();
  for (const name in channels) {
    const bodies = meta.bodies.filter((body) => meta.live ? name in body.most : body.most[name] > 0);
    if (bodies.length) ranges[name] = measureChannel(bodies, name, [...bodies[0].x.keys()]);
  }
  renderer = new Renderer(gl);
  ranges.stretch = measureStretch(renderer.parts,
    Array.from({ length: 10 }, (_, k) => Math.floor((k + 1) * lastFrame() / 10)));
  buildPlots();
  controlCamera(renderer);
  controlPlayer();
  buildHelp();
  buildOptions();
  addEventListener("hashchange", () => applyView(location.hash.slice(1)));
  applyView(location.hash.slice(1));
  $("message").hidden = true;
  document.body.classList.add("ready");
  if (location.search !== "?pictures") animate(); /* `projdyn render` asks for the pictures that it wants */
}

function animate() {
  const animation = new Animation(renderer);
  new ResizeObserver(() => animation.draw(0)).observe($("view"));
  animation.tick(performance.now());
  player.start();
}

start().catch((error) => {
  document.body.classList.add("plain", "failed");
  $("message").hidden = false;
  $("message").textContent = error.message;
});
