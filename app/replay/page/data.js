/* Decoding of the frames: the counterpart of replay_planes.c. */

/* Weights of the previous frame and of the one before it in the prediction of a value: none, constant,
 * linear extrapolation. replay_planes.c has the same table. */
const predictors = [[0, 0], [1, 0], [2, -1]];

/* Decodes base64 and decompresses. */
async function inflate(text) {
  const piece = 1 << 20, pieces = []; /* piece: base64 digits, a multiple of four */
  for (let i = 0; i < text.length; i += piece) {
    const digits = atob(text.slice(i, i + piece)), bytes = new Uint8Array(digits.length);
    for (let k = 0; k < digits.length; k++) bytes[k] = digits.charCodeAt(k);
    pieces.push(bytes);
  }
  const stream = new Blob(pieces).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/* Decodes one plane (replay_planes.h) into every `stride`-th value of `out`, from `offset` on. history: the
 * decoded frames so far; wide: 16 bits. Returns the position of the next plane. */
function readPlane(bytes, at, out, offset, stride, count, wide, history, frame) {
  const [first, second] = predictors[bytes[at++]];
  const before = history[frame - 1] || out, earlier = history[frame - 2] || out;
  const low = wide ? at + count : at, mask = wide ? 0xffff : 0xff;
  for (let i = 0, k = offset; i < count; i++, k += stride) {
    const code = wide ? bytes[at + i] << 8 | bytes[low + i] : bytes[at + i];
    const difference = code & 1 ? -(code + 1) >> 1 : code >> 1;
    out[k] = (first * before[k] + second * earlier[k] + difference) & mask;
  }
  return low + count;
}

/* Decodes frame f of a part: positions, then one plane for each of its channels. */
function readFrame(bytes, at, part, f) {
  const x = new Uint16Array(3 * part.count);
  for (let k = 0; k < 3; k++) at = readPlane(bytes, at, x, k, 3, part.count, true, part.x, f);
  part.x.push(x);
  for (const channel of part.channels) {
    const values = new Uint8Array(part.count);
    at = readPlane(bytes, at, values, 0, 1, part.count, false, part[channel], f);
    part[channel].push(values);
  }
  return at;
}

/* Decodes all data. Each part (bodies, solids, boundary points) gets .index (surfaces) and, for each frame, .x,
 * quantised in .box, and its channels. These arrays have .count points, the maximum over the frames;
 * .points[frame] of them are valid. A part at rest has one frame. */
function unpack(bytes) {
  const parts = allParts();
  let at = 0;
  for (const part of parts) {
    part.x = [];
    part.channels = Object.keys(part.most || {});
    for (const channel of part.channels) part[channel] = [];
    part.index = new Uint32Array(bytes.slice(at, at + 12 * part.triangles).buffer);
    at += 12 * part.triangles;
  }
  for (let f = 0; f < frameCount(); f++)
    for (const part of parts) if (!f || !part.rest) at = readFrame(bytes, at, part, f);
}

/* Positions of a part in a frame, and its number of points there. */
const positions = (part, frame) => part.x[part.rest ? 0 : frame];
/* Box of these positions, m, and the largest value of a channel: of all frames in a replay; in a live view each
 * frame has its own, because later ones are not known. */
const boxOf = (part, frame) => part.boxes ? part.boxes[frame] : part.box;
const mostOf = (part, channel, frame) => part.mosts ? part.mosts[frame][channel] : part.most[channel];
const pointsOf = (part, frame) => part.points ? part.points[frame] : part.count;
