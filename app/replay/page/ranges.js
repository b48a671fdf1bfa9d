/* Ranges of values over all frames: ends of the colour maps, bounds of the first view. */

/* Value of a channel from its 8 bits, which hold the square root. */
const channelValue = (part, channel, frame, code) => (code / 255) ** 2 * mostOf(part, channel, frame);

/* Range of a channel over some bodies and frames: top, the 99.5 % quantile, at which the colour map ends, because few larger
 * values would leave most colours unused; and most, the largest value. */
function measureChannel(bodies, channel, frames) {
  const histogram = new Float64Array(256);
  let total = 0, code = -1, sum = 0;
  const most = Math.max(0, ...bodies.flatMap((body) => frames.map((f) => mostOf(body, channel, f))));
  for (const body of bodies)
    for (const f of frames)
      for (let i = 0, values = body[channel][f]; i < body.points[f]; i += 7) {
        histogram[Math.ceil(Math.sqrt(channelValue(body, channel, f, values[i]) / (most || 1)) * 255)]++;
        total++;
      }
  while (code < 255 && sum <= 0.995 * total) sum += histogram[++code];
  return { top: (code / 255) ** 2 * most || 1e-6, most };
}

/* Range of coordinate k of a body in a frame, m; of particles above `floor` the 1 % and 99 % quantiles, so that single
 * ones that fly away do not shrink the view. Empty (Infinity, -Infinity) for a frame without points. */
function coordinateRange(body, f, k, floor) {
  const x = body.x[f], step = Math.max(1, Math.floor(body.points[f] / 2000)), values = [];
  const [low, high] = boxOf(body, f), rest = body.triangles ? 0 : 0.01;
  const least = body.triangles ? 0 : 65535 * (floor - low[vertical]) / (high[vertical] - low[vertical] || 1);
  for (let i = 0; i < body.points[f]; i += step) if (x[3 * i + vertical] >= least) values.push(x[3 * i + k]);
  if (!values.length) return [Infinity, -Infinity];
  values.sort((a, b) => a - b);
  const place = (part) => values[Math.round(part * (values.length - 1))] / 65535;
  return [rest, 1 - rest].map((part) => low[k] + (high[k] - low[k]) * place(part));
}

/* The same for all three coordinates. */
const coordinateRanges = (body, f, floor = -Infinity) => [0, 1, 2].map((k) => coordinateRange(body, f, k, floor));

/* The smallest bounds around several. Bounds are three pairs, m. */
const joinBounds = (list) => [0, 1, 2].map((k) =>
  [Math.min(...list.map((bounds) => bounds[k][0])), Math.max(...list.map((bounds) => bounds[k][1]))]);

/* Bounds of a part over all frames. */
const boundsOf = ({ box: [low, high] }) => low.map((v, k) => [v, high[k]]);

/* The frames that give the view, at most 80. */
function framesOfView() {
  const step = Math.max(1, Math.floor(frameCount() / 40));
  return [...meta.times.keys()].filter((f) => f % step === 0);
}

/* Marks surfaces that leave the scene, such as a body that falls off a table: they count for the view at the start
 * alone. The middle of what leaves is farther away than the size of the scene at the start, and something stays. */
function markLeavers() {
  const home = joinBounds([...meta.bodies.map((body) => coordinateRanges(body, 0)), ...solidParts().map(boundsOf)]);
  const far = Math.hypot(...home.map(([a, b]) => b - a));
  const isAway = (body, f) => coordinateRanges(body, f).some(([a, b], k) =>
    0.5 * (a + b) < home[k][0] - far || 0.5 * (a + b) > home[k][1] + far);
  const leavers = meta.bodies.filter((body) => framesOfView().some((f) => isAway(body, f)));
  const somethingStays = leavers.length < meta.bodies.length + solidParts().length;
  for (const body of leavers) body.leaves = somethingStays && body.triangles > 0;
}

/* Height below which particles have fallen out of the scene: half its height at the start below all solids and
 * surfaces. */
function floorOfView() {
  const tops = meta.bodies.map((body) => coordinateRange(body, 0, vertical, -Infinity)[1]), firm = firmBounds();
  const low = Math.min(...firm.map((bounds) => bounds[vertical][0]));
  const high = Math.max(...tops, ...firm.map((bounds) => bounds[vertical][1]));
  return firm.length ? low - 0.5 * (high - low) : -Infinity;
}

/* Extends the bounds by the boxes of parts that are not larger than `times` their largest side. */
function includeParts(bounds, parts, times) {
  const largest = times * (Math.max(...bounds.map(([a, b]) => b - a)) || 1);
  for (const box of parts.map(boundsOf))
    if (box.every(([low, high]) => high - low < largest)) bounds = joinBounds([bounds, box]);
  return bounds;
}

/* Solids to look at: those that move, and obstacles; no tanks and floors. */
const isSubject = (solid) => !solid.rest || ["mesh", "sphere", "capsule"].includes(solid.kind);

/* Whether a solid is a tank: a box at rest around the middle of the bounds. */
const isTank = (solid, bounds) => solid.rest && solid.kind === "box" &&
  bounds.every(([a, b], k) => solid.box[0][k] < 0.5 * (a + b) && 0.5 * (a + b) < solid.box[1][k]);

/* Bounds of the view: ranges of the coordinates of the bodies over the frames, solids to look at, and a tank that does
 * not make the bodies small. */
function measureBounds() {
  const floor = floorOfView();
  const bounds = joinBounds(meta.bodies.flatMap((body) =>
    (body.leaves ? [0] : framesOfView()).map((f) => coordinateRanges(body, f, floor))));
  if (bounds[0][0] > bounds[0][1]) return [[0, 1], [0, 1], [0, 1]];
  const subjects = includeParts(bounds, meta.solids.filter(isSubject), 3);
  return includeParts(subjects, meta.solids.filter((solid) => isTank(solid, subjects)), 1.5);
}

/* Extends the bounds down to the ground unless it is far below (0.7 times their largest side). */
function includeGround(bounds, ground) {
  const [low, high] = bounds[vertical], span = Math.max(...bounds.map(([a, b]) => b - a));
  if (low - ground < 0.7 * span) bounds[vertical] = [ground, high];
  return bounds;
}

/* The solids, or their boundary points if none has a mesh. */
const solidParts = () => meta.solids.length ? meta.solids : meta.boundary;

/* Bounds of what particles do not pass, solids and surfaces, while they are in the scene. */
const firmBounds = () => [...solidParts(), ...meta.bodies.filter((body) => body.triangles)]
  .map((part) => part.leaves ? coordinateRanges(part, 0) : boundsOf(part));

/* Height of the ground: below the bounds, solids and surfaces, and below all particles where nothing else is there:
 * single ones that have left a tank would let it float above the ground. m */
function groundHeight(bounds) {
  const floor = floorOfView(), firm = firmBounds(), parts = firm.length ? firm : meta.bodies.map(boundsOf);
  return Math.min(bounds[vertical][0], ...parts.map((part) => Math.max(floor, part[vertical][0])));
}

/* Bounds of a live view, whose later frames are not known: those of the first frame, with solids that are not much
 * larger than the bodies, and sides of at least 0.6 of the longest one; downwards, where things fall. */
function guessBounds(bounds) {
  bounds = includeParts(bounds, [...meta.solids, ...meta.boundary], 3);
  const least = 0.6 * (Math.max(...bounds.map(([a, b]) => b - a)) || 1);
  return bounds.map(([a, b], k) => {
    const more = Math.max(0, least - (b - a));
    return k === vertical ? [a - more, b] : [a - more / 2, b + more / 2];
  });
}
