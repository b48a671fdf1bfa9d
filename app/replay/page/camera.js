/* The camera: it orbits around a target. */
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/* Axes of a view whose direction has the angles yaw (around the vertical) and pitch (above the horizontal). */
function viewAxes(yaw, pitch) {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  const axes = { right: [cy, 0, -sy], up: [-sy * sp, cp, -cy * sp], back: [sy * cp, sp, cy * cp] };
  return Object.fromEntries(Object.entries(axes).map(([name, axis]) => [name, fromYUp(axis)]));
}

/* View matrix, column-major. */
function viewMatrix({ right, up, back }, eye) {
  return new Float32Array([0, 1, 2].flatMap((k) => [right[k], up[k], back[k], 0])
    .concat(-dot(right, eye), -dot(up, eye), -dot(back, eye), 1));
}

class Camera {
  /* pitch: of the first view, above the horizontal, rad */
  constructor(bounds, pitch) {
    this.bounds = bounds;
    this.first = pitch;
    this.field = 32 * Math.PI / 180;
    this.centre = bounds.map(([a, b]) => 0.5 * (a + b));
    this.radius = 0.5 * Math.hypot(...bounds.map(([a, b]) => b - a)) || 1;
    this.reset();
  }
  /* The first view: slightly from above, towards the longer side. */
  reset() {
    const size = this.bounds.map(([a, b]) => b - a), [wide, deep] = [size[0], size[3 - vertical]];
    this.target = this.centre.slice();
    this.yaw = wide >= 0.7 * deep ? 0.48 : Math.PI / 2 - 0.48;
    this.pitch = this.first;
    this.scale = 1; /* factor on the distance at which the bounds fit the window */
  }
  axes() {
    return viewAxes(this.yaw, this.pitch);
  }
  /* View and projection matrices, column-major, and the position of the eye. */
  matrices(aspect) {
    const half = Math.tan(this.field / 2), axes = this.axes();
    if (aspect !== this.aspect) this.fit(half, this.aspect = aspect);
    this.distance = this.scale * this.whole;
    const eye = this.target.map((t, k) => t + this.distance * axes.back[k]);
    const near = Math.max(0.02 * this.distance, this.distance - 20 * this.radius);
    const far = this.distance + 30 * this.radius;
    const depth = [(far + near) / (near - far), 2 * far * near / (near - far)];
    const scale = [1 / (half * aspect), 1 / half];
    const projection = new Float32Array([scale[0], 0, 0, 0, 0, scale[1], 0, 0, 0, 0, depth[0], -1, 0, 0, depth[1], 0]);
    return { view: viewMatrix(axes, eye), projection, eye };
  }
  /* Distance at which all corners of the bounds are in the window with a margin of 8 %, from the first direction. */
  fit(half, aspect) {
    const { right, up, back } = new Camera(this.bounds, this.first).axes();
    let distance = 0;
    for (let corner = 0; corner < 8; corner++) {
      const p = this.bounds.map((side, k) => side[corner >> k & 1] - this.centre[k]);
      const reach = Math.max(Math.abs(dot(right, p)) / aspect, Math.abs(dot(up, p)));
      distance = Math.max(distance, dot(back, p) + 1.08 * reach / half);
    }
    this.whole = distance || 1;
  }
  orbit(dx, dy) {
    this.yaw -= 0.006 * dx;
    this.pitch = Math.min(1.55, Math.max(-1.55, this.pitch + 0.006 * dy));
  }
  pan(dx, dy, height) {
    const { right, up } = this.axes(), scale = 2 * this.distance * Math.tan(this.field / 2) / height;
    this.target = this.target.map((t, k) => t + scale * (dy * up[k] - dx * right[k]));
  }
  zoom(factor) {
    this.scale = Math.min(5, Math.max(0.01, this.scale * factor));
  }
}
