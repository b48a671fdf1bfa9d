/* The panel of options, and the settings that it shows. */
const settings = { look: "surface", fluid: "plain", surface: "plain", cut: "", background: "studio" };
const ranges = {}; /* of the channels: {top, most} */
const inputs = {}; /* controls by their setting, and checkboxes of the parts by name */

/* The plane of a cut: settings.cut is empty or an axis, a side and a place from 0 to 1 within the bounds of the
 * view, such as "x-0.5": what has a smaller x than the middle is cut away. */
function cutPlane(camera) {
  const parts = /^([xyz])([+-])([0-9.]+)$/.exec(settings.cut);
  if (!parts) return [0, 0, 0, 1];
  const axis = "xyz".indexOf(parts[1]), side = parts[2] === "+" ? 1 : -1, [low, high] = camera.bounds[axis];
  const plane = [0, 0, 0, side * (low + Number(parts[3]) * (high - low))];
  plane[axis] = side;
  return plane;
}

/* Changes a setting, and its control. */
function change(name, value) {
  settings[name] = value;
  if (inputs[name] && inputs[name].value !== value) inputs[name].value = value;
  renderer.stale = true;
  player.dirty = true;
  showLegends();
}

function addSelect(parent, text, name, choices) {
  const label = element(parent, "label");
  element(label, "span", { textContent: text });
  const select = element(label, "select");
  for (const [value, title] of choices) element(select, "option", { value, textContent: title });
  select.value = settings[name];
  select.addEventListener("change", () => change(name, select.value));
  inputs[name] = select;
}

function addCheckbox(parent, part, detail) {
  const label = element(parent, "label"), box = element(label, "input", { type: "checkbox", checked: part.shown });
  label.append(part.name);
  element(label, "small", { textContent: detail });
  box.addEventListener("change", () => {
    part.shown = box.checked;
    renderer.stale = player.dirty = true;
    showLegends();
  });
  inputs["part " + part.name] = box;
}

function addCut(parent) {
  addSelect(parent, "Cut", "cut", [["", "none"]].concat(["x", "y", "z"].flatMap((axis) =>
    [[axis + "+", `${axis}, far side`], [axis + "-", `${axis}, near side`]])));
  const range = { type: "range", min: 0, max: 1, step: 0.005, value: 0.5 };
  const place = element(element(parent, "label"), "input", range);
  place.setAttribute("aria-label", "Place of the cut");
  place.before(element(place.parentNode, "span"));
  const apply = () => change("cut", inputs.cut.value && inputs.cut.value.slice(0, 2) + place.value);
  const select = inputs.cut;
  inputs.cut = {
    get value() { return select.value; },
    set value(text) {
      select.value = text.slice(0, 2);
      if (text) place.value = text.slice(2);
      place.parentNode.hidden = !text;
    },
  };
  place.parentNode.hidden = true;
  for (const [input, event] of [[select, "change"], [place, "input"]]) input.addEventListener(event, apply);
}

/* Choices of a colour; quantities that are 0 in the whole run are left out. */
const titled = (names) => names.filter((name) => !(name in channels) || ranges[name])
  .map((name) => [name, channels[name]?.label || name]);

function buildOptions() {
  const parts = element($("options"), "div"), looks = element($("options"), "div");
  const number = (count, what) => `${count.toLocaleString("en")} ${what}`;
  for (const body of meta.bodies) addCheckbox(parts, body, number(body.count, body.triangles ? "vertices" : "particles"));
  for (const solid of meta.solids) addCheckbox(parts, solid, solid.kind);
  for (const part of meta.boundary) addCheckbox(parts, part, number(part.count, "points"));
  const particles = meta.bodies.filter((b) => !b.triangles), fluid = particles.some((b) => b.fluid);
  if (fluid) addSelect(looks, "Water as", "look", [["surface", "surface"], ["particles", "particles"]]);
  if (particles.length)
    addSelect(looks, fluid ? "Water" : "Colour", "fluid", titled(["plain", "speed", "error", "pressure"]));
  if (meta.bodies.some((b) => b.triangles))
    addSelect(looks, particles.length ? "Surfaces" : "Colour", "surface", titled(["plain", "checker", "speed", "stretch"]));
  addSelect(looks, "Background", "background", [["studio", "studio"], ["white", "white"]]);
  addCut(looks);
  $("options").hidden = false;
  $("options").open = $("view").clientWidth > 560;
}
