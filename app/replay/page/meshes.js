/* Triangle meshes: normals, creases, edges, rest lengths. Positions are in m, 3 numbers a vertex. */

/* Positions of a part in a frame, m. */
function metres(part, frame) {
  const x = positions(part, frame), [low, high] = boxOf(part, frame), size = high.map((v, k) => (v - low[k]) / 65535);
  const out = new Float32Array(x.length);
  for (let i = 0; i < x.length; i++) out[i] = low[i % 3] + size[i % 3] * x[i];
  return out;
}

/* Normal of triangle t times twice its area. */
function triangleNormal(x, index, t) {
  const [a, b, c] = [0, 1, 2].map((k) => 3 * index[3 * t + k]);
  const u = [x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2]];
  const v = [x[c] - x[a], x[c + 1] - x[a + 1], x[c + 2] - x[a + 2]];
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
}

/* Sums of the triangles' normals at the vertices, weighted by area: shaders normalise them. */
function sumNormals(x, index, out) {
  out.fill(0);
  for (let t = 0; 3 * t < index.length; t++) {
    const n = triangleNormal(x, index, t);
    for (let k = 0; k < 3; k++)
      for (let c = 0, p = 3 * index[3 * t + k]; c < 3; c++) out[p + c] += n[c];
  }
  return out;
}

/* Numbers of vertices with one number for vertices at the same place. */
function weld(x) {
  const known = new Map();
  return Array.from({ length: x.length / 3 }, (_, i) => {
    const key = `${x[3 * i]},${x[3 * i + 1]},${x[3 * i + 2]}`;
    if (!known.has(key)) known.set(key, i);
    return known.get(key);
  });
}

/* Splits the vertices of a mesh where normals turn by more than 40 degrees. Returns the corners as indices of new
 * vertices, and the old vertex of each new one. */
function splitCreases(x, index) {
  const same = weld(x), groups = new Map(), source = [], corners = new Uint32Array(index.length);
  for (let i = 0; i < index.length; i++) {
    const n = triangleNormal(x, index, Math.floor(i / 3)), length = Math.hypot(...n) || 1;
    const unit = n.map((v) => v / length);
    const vertex = same[index[i]];
    if (!groups.has(vertex)) groups.set(vertex, []);
    let group = groups.get(vertex).find((g) => dot(g.normal, unit) > 0.766 * Math.hypot(...g.normal));
    if (!group) {
      groups.get(vertex).push(group = { normal: [0, 0, 0], index: source.length });
      source.push(index[i]);
    }
    group.normal = group.normal.map((v, k) => v + n[k]);
    corners[i] = group.index;
  }
  return { index: corners, source };
}

/* Edges of a mesh: a map from "a,b" (a < b, welded vertices) to the triangles that have it. */
function findEdges(x, index) {
  const same = weld(x), edges = new Map();
  for (let i = 0; i < index.length; i++) {
    const a = same[index[i]], b = same[index[i % 3 === 2 ? i - 2 : i + 1]], key = a < b ? `${a},${b}` : `${b},${a}`;
    if (!edges.has(key)) edges.set(key, []);
    edges.get(key).push(Math.floor(i / 3));
  }
  return edges;
}

/* Pairs of vertices at the borders of a mesh and where it turns by more than 30 degrees. */
function sharpEdges(x, index) {
  const pairs = [];
  for (const [key, triangles] of findEdges(x, index)) {
    const normals = triangles.map((t) => triangleNormal(x, index, t)), [n, m] = normals;
    const sharp = normals.length !== 2 || dot(n, m) < 0.866 * Math.hypot(...n) * Math.hypot(...m);
    if (sharp) pairs.push(...key.split(",").map(Number));
  }
  return pairs;
}

/* Whether every edge of a mesh has two triangles: the surface of a solid, not a sheet. */
const isClosed = (x, index) => [...findEdges(x, index).values()].every((triangles) => triangles.length === 2);

/* Coordinates of a checker on a mesh, m: its positions along its principal axes, longest first; a sheet has no
 * third one. */
function checkerCoordinates(x, index, closed) {
  const used = [...new Set(index)];
  const mean = [0, 1, 2].map((k) => used.reduce((sum, i) => sum + x[3 * i + k], 0) / used.length);
  const moment = [0, 1, 2].map((j) => [0, 1, 2].map((k) =>
    used.reduce((sum, i) => sum + (x[3 * i + j] - mean[j]) * (x[3 * i + k] - mean[k]), 0)));
  const unit = (a) => a.map((v) => v / (Math.hypot(...a) || 1));
  const times = (a) => moment.map((row) => dot(row, a));
  let first = [0.8, 0.5, 0.33], second = [-0.4, 0.3, 0.86];
  for (let k = 0; k < 60; k++) { /* power iteration on the moments */
    first = unit(times(first));
    second = unit(times(second));
    second = unit(second.map((v, c) => v - dot(first, second) * first[c]));
  }
  const axes = [first, second, cross(first, second)], out = new Float32Array(x.length);
  for (let i = 0; i < x.length; i++) {
    const p = [0, 1, 2].map((k) => x[i - i % 3 + k] - mean[k]);
    out[i] = i % 3 === 2 && !closed ? 0 : dot(axes[i % 3], p);
  }
  return out;
}

/* Mean over a vertex's edges of length over length in frame 0, minus one. edges: pairs of vertices */
function vertexStretch(edges, rest, x, out) {
  const count = new Uint16Array(x.length / 3);
  out.fill(0);
  for (let e = 0; 2 * e < edges.length; e++) {
    const a = edges[2 * e], b = edges[2 * e + 1];
    const length = Math.hypot(x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2]);
    for (const v of [a, b]) {
      out[v] += length / rest[e] - 1;
      count[v]++;
    }
  }
  for (let v = 0; v < count.length; v++) out[v] /= count[v] || 1;
  return out;
}

/* The walls of a box as bounds [low, high] for what is in it: an open side has none. box: of the mesh */
function boxWalls(x, index, [low, high]) {
  const walls = [[-1e9, -1e9, -1e9], [1e9, 1e9, 1e9]];
  for (let t = 0; t < index.length; t += 3)
    for (let k = 0; k < 3; k++)
      [low, high].forEach((side, s) => {
        const near = (c) => Math.abs(x[3 * index[t + c] + k] - side[k]) < 1e-5 * (high[k] - low[k]);
        if ([0, 1, 2].every(near)) walls[s][k] = side[k];
      });
  return walls;
}

/* Whether a triangle of a mesh meets the ray from p towards d (Moeller, Trumbore 1997). */
function meetsRay(x, index, p, d) {
  const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => x.subarray(3 * index[t + k], 3 * index[t + k] + 3));
    const u = minus(b, a), v = minus(c, a), n = cross(d, v), volume = dot(u, n);
    const r = minus(p, a), q = cross(r, u), alpha = dot(r, n) / volume, beta = dot(d, q) / volume;
    if (alpha >= 0 && beta >= 0 && alpha + beta <= 1 && dot(v, q) / volume > 0) return true;
  }
  return false;
}

/* Whether most points of a body in a frame are in the box of a solid and behind its mesh, seen from the direction
 * `back`. */
function hidesBody(solid, body, f, back) {
  const x = metres(solid, f), p = metres(body, f), count = pointsOf(body, f), step = Math.max(1, Math.floor(count / 50));
  const [low, high] = boxOf(solid, f), sample = [];
  for (let i = 0; i < count; i += step) sample.push(p.subarray(3 * i, 3 * i + 3));
  const within = sample.filter((at) => at.every((v, k) => v > low[k] && v < high[k]));
  return 2 * within.length > sample.length &&
    2 * within.filter((at) => meetsRay(x, solid.index, at, back)).length > sample.length;
}
