/* The camera over time, for `projdyn render --camera`: keys {time, yaw, pitch, scale, target} of which each has the
 * time and some of the others. */
const cameraValues = {
  yaw: { count: 1, least: -1e6, most: 1e6, unit: " degrees" },
  pitch: { count: 1, least: -89, most: 89, unit: " degrees" },
  scale: { count: 1, least: 0.01, most: 100, unit: "" },
  target: { count: 3, least: -1e6, most: 1e6, unit: " m" },
};

/* What is wrong with the value of a name in a key; "": nothing. */
function cameraValueFault(name, value) {
  const { count, least, most, unit } = cameraValues[name], numbers = [value].flat();
  const good = Array.isArray(value) === count > 1 && numbers.length === count &&
    numbers.every((v) => typeof v === "number" && v >= least && v <= most);
  return good ? "" : `expected ${count > 1 ? count + " numbers" : "a number"} from ${least} to ${most}${unit}, found ${JSON.stringify(value)}`;
}

/* What is wrong with key k; "": nothing. */
function cameraKeyFault(keys, k) {
  const key = keys[k], names = Object.keys(cameraValues), last = k ? keys[k - 1]?.time : -Infinity;
  if (typeof key !== "object" || !key || Array.isArray(key)) return `[${k}]: expected an object, found ${JSON.stringify(key)}`;
  if (!("time" in key)) return `[${k}]: missing key "time"`;
  if (typeof key.time !== "number" || !(key.time > last))
    return `[${k}].time: expected a number${k ? ` above ${last} s, the time of the key before` : ""}, found ${JSON.stringify(key.time)}`;
  const unknown = Object.keys(key).find((name) => name !== "time" && !names.includes(name));
  if (unknown) return `[${k}]: ${expectedIn("unknown key", unknown, ["time", ...names])}`;
  const bad = names.find((name) => name in key && cameraValueFault(name, key[name]));
  if (bad) return `[${k}].${bad}: ${cameraValueFault(bad, key[bad])}`;
  return Object.keys(key).length > 1 ? "" : `[${k}]: expected one of ${names.join(", ")} beside the time`;
}

let cameraKeys = [];

/* Takes keys for the pictures from now on. Returns what is wrong with them; "": nothing. */
function useCamera(keys) {
  if (!Array.isArray(keys) || !keys.length) return "expected an array of at least one key";
  const fault = keys.map((_, k) => cameraKeyFault(keys, k)).find(Boolean) || "";
  if (!fault) cameraKeys = keys;
  return fault;
}

/* Value at a time of the monotone cubic curve (Fritsch and Butland 1984) through points [time, value]: smooth, never
 * beyond the two values around, a line for two points; constant before the first and after the last one. */
function curveAt(points, time) {
  const last = points.length - 1, next = points.findIndex(([t]) => t > time);
  if (next < 1) return points[next < 0 ? last : 0][1];
  const width = (k) => points[k + 1][0] - points[k][0], secant = (k) => (points[k + 1][1] - points[k][1]) / width(k);
  const slope = (k) => {
    if (k === 0 || k === last) return secant(k && k - 1);
    const [a, b, before, after] = [secant(k - 1), secant(k), width(k - 1), width(k)];
    return a * b > 0 ? 3 * (before + after) / ((before + 2 * after) / a + (2 * before + after) / b) : 0;
  };
  const k = next - 1, h = width(k), s = (time - points[k][0]) / h, r = 1 - s;
  return r * r * ((1 + 2 * s) * points[k][1] + s * h * slope(k)) + s * s * ((1 + 2 * r) * points[next][1] - r * h * slope(next));
}

/* Gives the camera the values that the keys have at a time; values that no key has stay. */
function moveCamera(camera, time) {
  for (const name in cameraValues) {
    const keys = cameraKeys.filter((key) => name in key);
    const at = (read) => curveAt(keys.map((key) => [key.time, read(key[name])]), time);
    if (!keys.length) continue;
    if (name === "target") camera.target = [0, 1, 2].map((a) => at((place) => place[a]));
    else camera[name] = at(Number) * (name === "scale" ? 1 : Math.PI / 180);
  }
}
