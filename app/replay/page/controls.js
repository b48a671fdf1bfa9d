/* Sliders of a live view: the parameters of the constraints that can be changed, and gravity. */

/* Scale of a slider, from the place 0...1 to a value and back: linear within narrow bounds, otherwise logarithmic from
 * a hundredth to a hundred times the value; for 0, which has no logarithm, cubic from 0 to 1. */
function sliderScale({ value, minimum, maximum }) {
  const low = minimum ?? -Infinity, high = maximum ?? Infinity;
  const narrow = high - low <= 2 || low > 0 && high < 100 * low;
  if (narrow) return { value: (t) => low + t * (high - low), place: (v) => (v - low) / (high - low) };
  if (value > 0) {
    const first = Math.max(low, value / 100), span = Math.log(Math.min(high, value * 100) / first);
    return { value: (t) => first * Math.exp(t * span), place: (v) => Math.log(v / first) / span };
  }
  const first = Math.max(low, value), span = Math.min(high, first + 1) - first;
  return { value: (t) => first + span * t ** 3, place: (v) => Math.cbrt((v - first) / span) };
}

/* A slider with a number beside it. send(value): called for each change */
class Control {
  constructor(parent, parameter, scale, send) {
    const { name, unit, doc, value } = parameter;
    Object.assign(this, { parameter, scale, send, first: value });
    this.row = element(parent, "div", { className: "control", title: doc });
    element(this.row, "span", { textContent: name.replaceAll("_", " ") });
    this.reset = element(this.row, "button", { textContent: "↺", title: "Back to the value of the scene" });
    this.number = element(this.row, "input", { type: "number", step: "any" });
    element(this.row, "small", { textContent: unit === "1" ? "" : unit });
    this.slider = element(this.row, "input", { type: "range", min: 0, max: 1, step: 0.002 });
    for (const input of [this.number, this.slider]) input.setAttribute("aria-label", `${name}, ${unit}`);
    this.slider.addEventListener("input", () => this.change(Number(scale.value(Number(this.slider.value)).toPrecision(3))));
    this.number.addEventListener("change", () => this.number.value !== "" && this.change(Number(this.number.value)));
    this.reset.addEventListener("click", () => this.change(this.first));
    this.show(value);
  }
  change(value) {
    this.show(value);
    this.send(value);
  }
  /* A slider that the mouse holds stays. */
  show(value) {
    if (document.activeElement !== this.number || Number(this.number.value) !== value)
      this.number.value = Number(value.toPrecision(6));
    if (!this.slider.matches(":active")) this.slider.value = this.scale.place(value);
    this.reset.style.visibility = value === this.first ? "hidden" : "visible";
  }
}

const gravityScale = { value: (t) => Math.round(400 * (t - 0.5)) / 10, place: (v) => 0.5 + v / 40 };

/* The panel: a group of controls for each constraint, and gravity. */
class Controls {
  constructor(parent, send) {
    this.send = send;
    this.groups = element(parent, "section", { id: "controls" });
    this.forGravity = this.group("gravity");
    this.forGravity.classList.add("short");
    this.parameters = [];
    this.gravity = [];
  }
  group(title) {
    const details = element(this.groups, "details", { open: true });
    element(details, "summary", { textContent: title });
    return details;
  }
  /* Controls of parameters: those of the server's list, which has the same entries every time. */
  showParameters(list) {
    this.known = list;
    if (this.parameters.length) return this.parameters.forEach((control, k) => control.show(list[k].value));
    let last = -1, group;
    this.parameters = list.map((parameter) => {
      const { constraint, name } = parameter;
      if (constraint !== last) group = this.group(`${parameter.body} · ${parameter.type}`);
      last = constraint;
      return new Control(group, parameter, sliderScale(parameter),
        (value) => this.send({ do: "set", constraint, name, value }));
    });
  }
  showGravity(vector) {
    this.vector = vector.slice();
    if (this.gravity.length) return this.gravity.forEach((control, k) => control.show(vector[k]));
    this.gravity = vector.map((value, k) =>
      new Control(this.forGravity, { name: "xyz"[k], unit: "m/s²", doc: "acceleration of all bodies", value }, gravityScale, (v) => {
        this.vector[k] = v;
        this.send({ do: "gravity", value: this.vector });
      }));
  }
  /* After a value that was refused. */
  showKnown() {
    if (this.known) this.showParameters(this.known);
  }
}
