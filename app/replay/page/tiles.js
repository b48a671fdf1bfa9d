/* Tiles of the window that particles cover, so that the passes over the window leave out the rest: a software
 * renderer spends the same time on a pixel without water. */
const tilesWide = 40, tilesHigh = 25;

const tileVertex = `
layout(location = 0) in vec2 corner; /* of two triangles a tile, in tiles */
out vec2 uv;
void main() {
  uv = corner / vec2(${tilesWide}, ${tilesHigh});
  gl_Position = vec4(2.0 * uv - 1.0, 0, 1);
}`;

/* Rows 0, 1 and 3 of the matrix from quantised positions in a box to the window's coordinates. */
function windowRows({ view, projection }, [low, high]) {
  const all = [0, 1, 3].map((i) => [0, 1, 2, 3].map((j) =>
    [0, 1, 2, 3].reduce((sum, k) => sum + projection[4 * k + i] * view[4 * j + k], 0)));
  return all.map((row) => [...[0, 1, 2].map((k) => row[k] * (high[k] - low[k]) / 65535), dot(row, low) + row[3]]);
}

class Tiles {
  constructor(gl) {
    this.gl = gl;
    this.covered = new Uint8Array(tilesWide * tilesHigh);
    this.array = gl.createVertexArray();
    this.buffer = addAttribute(gl, this.array, 0, 2, gl.FLOAT);
  }
  coverBox(left, right, low, high) {
    for (let y = Math.max(0, low); y <= Math.min(tilesHigh - 1, high); y++)
      for (let x = Math.max(0, left); x <= Math.min(tilesWide - 1, right); x++) this.covered[y * tilesWide + x] = 1;
  }
  /* Adds the tiles of a body's particles and those around them. reach: radius on the window of a ball at w = 1, as a
   * part of its height */
  coverBody(part, frame, values, reach) {
    const x = positions(part, frame), rows = windowRows(values, boxOf(part, frame));
    const aspect = values.projection[5] / values.projection[0];
    const at = (row, i) => row[0] * x[i] + row[1] * x[i + 1] + row[2] * x[i + 2] + row[3];
    for (let p = 0; p < pointsOf(part, frame); p++) {
      const w = at(rows[2], 3 * p);
      if (w <= 0) continue;
      const u = (0.5 + 0.5 * at(rows[0], 3 * p) / w) * tilesWide;
      const v = (0.5 + 0.5 * at(rows[1], 3 * p) / w) * tilesHigh;
      const high = reach / w * tilesHigh + 0.4, wide = reach / w / aspect * tilesWide + 0.4;
      this.coverBox(Math.floor(u - wide), Math.floor(u + wide), Math.floor(v - high), Math.floor(v + high));
    }
  }
  update(shapes, frame, values) {
    this.covered.fill(0);
    for (const { part } of shapes) this.coverBody(part, frame, values, part.radius * values.projection[5]);
    const list = [];
    this.covered.forEach((on, k) => {
      const x = k % tilesWide, y = Math.floor(k / tilesWide);
      if (on) list.push(x, y, x + 1, y, x, y + 1, x, y + 1, x + 1, y, x + 1, y + 1);
    });
    this.count = list.length / 2;
    fillBuffer(this.gl, this.buffer, Float32Array.from(list));
  }
  draw(program, values) {
    use(this.gl, program, values);
    this.gl.bindVertexArray(this.array);
    this.gl.drawArrays(this.gl.TRIANGLES, 0, this.count);
  }
}
