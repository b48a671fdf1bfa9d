/* The view as text, in the part of the URL after '#':
 *   frame=30&play=0            a frame, not playing
 *   hide=water,tank&show=boundary   parts
 *   look=particles&fluid=speed&surface=checker&cut=x-0.5   settings
 *   camera=yaw,pitch,scale,x,y,z    degrees; factor on the distance; target, m: without it, the
 *                                   middle of the bounds */

function viewText() {
  const { yaw, pitch, scale, target } = renderer.camera, short = (v) => String(Number(v.toPrecision(4)));
  const view = { frame: player.frame, play: 0 };
  const parts = allParts(), names = (list) => list.map((p) => p.name).join(",");
  view.hide = names(parts.filter((p) => p.usual && !p.shown));
  view.show = names(parts.filter((p) => !p.usual && p.shown));
  for (const name in settings) if (settings[name] !== usualSettings[name]) view[name] = settings[name];
  view.camera = [yaw * 180 / Math.PI, pitch * 180 / Math.PI, scale, ...target].map(short).join(",");
  return Object.entries(view).filter(([, value]) => value !== "")
    .map(([name, value]) => `${name}=${encodeURIComponent(value)}`).join("&").replaceAll("%2C", ",").replaceAll("%2B", "+");
}

const usualSettings = { ...settings };

/* Whether a setting may have this value. */
const isSetting = (name, value) => name === "cut" ? /^([xyz][+-][0-9.]+)?$/.test(value)
  : inputs[name] && [...inputs[name].options].some((option) => option.value === value);

/* What is wrong with the value of camera; "": nothing. */
function cameraFault(value) {
  const texts = value.split(","), [yaw, pitch, scale, ...target] = texts.map((text) => text.trim() ? Number(text) : NaN);
  if (![3, 6].includes(texts.length) || ![yaw, pitch, scale, ...target].every(Number.isFinite))
    return `camera: expected three or six numbers: yaw,pitch,scale or yaw,pitch,scale,x,y,z, found "${value}"`;
  const values = Object.entries({ yaw, pitch, scale, ...(target.length && { target }) });
  const [name, bad] = values.find(([name, v]) => cameraValueFault(name, v)) || [];
  return name ? `camera: ${name}: ${cameraValueFault(name, bad)}` : "";
}

const expectedIn = (what, found, known) => `${what} "${found}"; known: ${known.join(", ")}`;

/* What is wrong with one name=value of a view; "": nothing. */
function pairFault(name, value) {
  const parts = allParts().map((part) => part.name);
  if (name === "frame" || name === "play") return /^[0-9]+$/.test(value) ? "" : `${name}: expected a number, found "${value}"`;
  if (name === "hide" || name === "show") {
    const unknown = value.split(",").find((part) => part && !parts.includes(part));
    return unknown ? expectedIn(`${name}: unknown part`, unknown, parts) : "";
  }
  if (name === "camera") return cameraFault(value);
  if (!(name in settings)) return expectedIn("unknown name", name, ["frame", "play", "hide", "show", "camera", ...Object.keys(settings)]);
  if (!inputs[name] || isSetting(name, value)) return ""; /* a setting of bodies that this run lacks */
  return name === "cut" ? `cut: expected a text as x-0.5, found "${value}"`
    : expectedIn(`${name}: unknown value`, value, [...inputs[name].options].map((option) => option.value));
}

/* A text of a URL; one with a '%' that begins no code stays as it is. */
function decodeText(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/* The names and values of a view. */
const viewPairs = (text) => text.split("&").filter(Boolean).map((pair) => {
  const [name, value = ""] = pair.split("=");
  return [name, decodeText(value)];
});

/* What is wrong with a view; "": nothing. */
const viewFault = (text) => viewPairs(text).map(([name, value]) => pairFault(name, value)).find(Boolean) || "";

/* Applies a view; what the text does not name becomes as usual. */
function applyView(text) {
  const wanted = Object.fromEntries(viewPairs(text));
  const [hidden, more] = ["hide", "show"].map((name) => (wanted[name] || "").split(","));
  for (const part of allParts()) {
    part.shown = part.usual ? !hidden.includes(part.name) : more.includes(part.name);
    inputs["part " + part.name].checked = part.shown;
  }
  for (const name in settings)
    change(name, name in wanted && isSetting(name, wanted[name]) ? wanted[name] : usualSettings[name]);
  renderer.camera.reset();
  if (wanted.camera && !cameraFault(wanted.camera)) {
    const [yaw, pitch, scale, ...target] = wanted.camera.split(",").map(Number);
    Object.assign(renderer.camera, { yaw: yaw * Math.PI / 180, pitch: pitch * Math.PI / 180, scale });
    if (target.length) renderer.camera.target = target;
  }
  player.open(Math.floor(Number(wanted.frame)) || 0, wanted.play !== "0");
}

function copyLink() {
  history.replaceState(null, "", "#" + viewText());
  return navigator.clipboard?.writeText(location.href);
}
