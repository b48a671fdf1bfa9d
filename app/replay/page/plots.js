/* Plots of the numbers of metrics.csv over time. */
const margin = { left: 46, right: 10, top: 8, bottom: 30 };
const charts = [
  { title: "Density error", unit: "%", log: true, factor: 100, fluid: true,
    lines: [["density_error_mean", "mean", "#009e73"], ["density_error_max", "max", "#8a5fb0"]] },
  { title: "Energy", unit: "J",
    lines: [["kinetic_J", "kinetic", "#0072b2"], ["potential_J", "potential", "#c98a00"],
      ["constraint_J", "constraint", "#c4553b"]] },
  { title: "Iterations per step", unit: "", log: true,
    lines: [["outer_iterations", "outer", "#c4553b"], ["linear_iterations", "linear", "#5b6b7d"]] },
];

/* Scales of a plot: ticks, and place(), which maps a value to 0...1 along the axis. Ticks are powers of ten or
 * multiples of 1, 2 or 5 times a power of ten. */
function logScale(values) {
  const positive = values.filter((v) => v > 0);
  const largest = positive.reduce((a, b) => Math.max(a, b), 0) || 1;
  const smallest = Math.max(positive.reduce((a, b) => Math.min(a, b), largest), 1e-5 * largest);
  const min = 10 ** Math.floor(Math.log10(smallest) + 1e-9), max = 10 ** Math.max(Math.ceil(Math.log10(largest) - 1e-9), Math.log10(min) + 1);
  const ticks = [];
  for (let v = min; v < 1.01 * max; v *= 10) ticks.push(Number(v.toPrecision(1)));
  return { ticks, place: (v) => v > 0 ? Math.max(0, Math.log(v / min) / Math.log(max / min)) : NaN };
}
function linearScale(low, high, about) {
  const span = high - low || Math.abs(high) || 1, raw = span / about, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((s) => s * power >= raw) * power;
  const min = Math.floor(low / step + 1e-9) * step, max = Math.max(Math.ceil(high / step - 1e-9) * step, min + step);
  const ticks = [];
  for (let k = 0; k <= Math.round((max - min) / step); k++) ticks.push(Number((min + k * step).toPrecision(10)));
  return { ticks, place: (v) => (v - min) / (max - min) };
}

/* Text of a tick; powers of ten below 1e-3 and from 1e6 on are written as 10 with an exponent. */
function tickLabel(value, log) {
  const power = Math.round(Math.log10(value));
  if (!log || power > -4 && power < 6) return formatNumber(value);
  return "10" + String(power).replace("-", "⁻").replace(/\d/g, (d) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[d]);
}

class Plot {
  constructor(parent, chart) {
    this.chart = chart;
    this.lines = chart.lines.map(([column, name, colour]) => ({ column, name, colour }));
    this.read();
    const figure = element(parent, "figure"), caption = element(figure, "figcaption");
    const heading = element(caption, "div");
    element(heading, "b", { textContent: chart.title });
    element(heading, "i", { textContent: [chart.unit, chart.log ? "log scale" : ""].filter(Boolean).join(", ") });
    for (const line of this.lines) {
      line.readout = element(caption, "span");
      line.readout.style.setProperty("--key", line.colour);
    }
    this.box = element(figure, "div", { className: "plot" });
    this.canvas = element(this.box, "canvas");
    this.cursor = element(this.box, "hr");
    for (const event of ["pointerdown", "pointermove"])
      this.box.addEventListener(event, (e) => {
        if (!(e.buttons & 1)) return;
        if (event === "pointerdown") this.box.setPointerCapture(e.pointerId);
        const left = e.clientX - this.box.getBoundingClientRect().left - margin.left;
        player.show(nearestFrame(left / this.width * this.last));
      });
    new ResizeObserver(() => this.draw()).observe(this.box);
  }
  /* Takes the numbers from the columns. */
  read() {
    this.time = meta.metrics.time_s.slice();
    this.last = Math.max(meta.times[lastFrame()], this.time[this.time.length - 1] || 0) || 1;
    for (const line of this.lines)
      line.values = meta.metrics[line.column].map((v) => v === null ? NaN : v * (this.chart.factor || 1));
  }
  draw() {
    const ratio = devicePixelRatio || 1, c = this.canvas.getContext("2d");
    const wide = this.box.clientWidth, high = this.box.clientHeight;
    this.canvas.width = Math.round(wide * ratio);
    this.canvas.height = Math.round(high * ratio);
    c.scale(ratio, ratio);
    this.width = wide - margin.left - margin.right;
    this.height = high - margin.top - margin.bottom;
    this.cursor.style.top = margin.top + "px";
    this.cursor.style.height = this.height + "px";
    this.drawAxes(c);
    c.save();
    c.beginPath();
    c.rect(margin.left, margin.top - 2, this.width, this.height + 4);
    c.clip();
    for (const line of this.lines) this.drawLine(c, line);
    c.restore();
    this.show(player.frame);
  }
  drawAxes(c) {
    const all = this.lines.flatMap((l) => l.values).filter(Number.isFinite);
    this.scale = this.chart.log ? logScale(all)
      : linearScale(Math.min(0, all.reduce((a, b) => Math.min(a, b), 0)), all.reduce((a, b) => Math.max(a, b), 0), this.height / 32);
    const bottom = margin.top + this.height, across = linearScale(0, this.last, this.width / 70);
    c.font = "11px " + getComputedStyle(document.body).fontFamily;
    c.fillStyle = "#66717e";
    c.strokeStyle = "#e3e7eb";
    c.textBaseline = "middle";
    c.textAlign = "right";
    for (const tick of this.scale.ticks) {
      const y = Math.round(bottom - this.height * this.scale.place(tick)) + 0.5;
      c.beginPath();
      c.moveTo(margin.left, y);
      c.lineTo(margin.left + this.width, y);
      c.stroke();
      c.fillText(tickLabel(tick, this.chart.log), margin.left - 7, y);
    }
    c.textAlign = "center";
    for (const tick of across.ticks.filter((t) => t <= 1.0001 * this.last))
      c.fillText(formatNumber(tick), margin.left + this.width * tick / this.last, bottom + 11);
    c.fillText("time (s)", margin.left + this.width / 2, bottom + 24);
  }
  drawLine(c, line) {
    c.strokeStyle = line.colour;
    c.lineWidth = 1.4;
    c.lineJoin = "round";
    c.beginPath();
    let open = false;
    line.values.forEach((value, i) => {
      const part = this.scale.place(value);
      if (Number.isFinite(part)) {
        const x = margin.left + this.width * this.time[i] / this.last, y = margin.top + this.height * (1 - part);
        if (open) c.lineTo(x, y);
        else c.moveTo(x, y);
      }
      open = Number.isFinite(part);
    });
    c.stroke();
  }
  show(frame) {
    const time = meta.times[frame];
    this.cursor.style.transform = `translateX(${margin.left + this.width * Math.min(1, time / this.last)}px)`;
    const step = lastBefore(this.time, time + 1e-9);
    for (const line of this.lines) {
      const value = step < 0 ? NaN : line.values[step];
      line.readout.textContent = `${line.name} ${Number.isFinite(value) ? formatNumber(value) : "–"}`;
    }
  }
}

/* Index of the last of rising numbers that is at most `limit`, -1 for none. */
function lastBefore(numbers, limit) {
  let low = -1, high = numbers.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= limit) low = middle;
    else high = middle;
  }
  return low;
}

function nearestFrame(time) {
  const below = Math.max(0, lastBefore(meta.times, time)), above = Math.min(lastFrame(), below + 1);
  return time - meta.times[below] < meta.times[above] - time ? below : above;
}
