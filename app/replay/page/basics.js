/* Short names and text of numbers. */
const $ = (id) => document.getElementById(id);
const meta = JSON.parse($("meta").textContent);
const frameCount = () => meta.times.length; /* grows in a live view */
const lastFrame = () => frameCount() - 1;
/* Index of the axis that points up, y or z. */
const vertical = meta.up === "z" ? 2 : 1;
/* A vector given with y up, in the axes of the scene: turned about x where z is up. */
const fromYUp = ([x, y, z]) => vertical === 2 ? [x, -z, y] : [x, y, z];
const allParts = () => [...meta.bodies, ...meta.solids, ...meta.boundary];

function element(parent, tag, properties = {}) {
  const e = Object.assign(document.createElement(tag), properties);
  parent.append(e);
  return e;
}

/* A number as text with some significant digits; with an exponent only below 1e-4 and from 1e5 on. */
function formatNumber(value, digits = 3) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) return value.toExponential(digits - 1).replace("e+", "e");
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}
