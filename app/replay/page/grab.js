/* Pulling a vertex of a sheet or soft body with the mouse, in a live view. */
const grabReach = 18; /* CSS pixels around the pointer */

/* Position of a point on the canvas in CSS pixels, and its distance from the eye along the view, m. */
function project(camera, canvas, p) {
  const { view, projection } = camera.matrices(canvas.width / canvas.height);
  const at = [0, 1, 2].map((k) => view[k] * p[0] + view[4 + k] * p[1] + view[8 + k] * p[2] + view[12 + k]);
  const x = projection[0] * at[0] / -at[2], y = projection[5] * at[1] / -at[2];
  return { x: (0.5 + 0.5 * x) * canvas.clientWidth, y: (0.5 - 0.5 * y) * canvas.clientHeight, depth: -at[2] };
}

const vertexPlace = (x, i) => [x[3 * i], x[3 * i + 1], x[3 * i + 2]];

/* The vertex under a point of the canvas, of those that are shown: among the vertices near to it, the nearest one of
 * the foremost layer. undefined: none. */
function pickVertex(camera, canvas, pointer, frame) {
  let found = [];
  meta.bodies.forEach((part, body) => {
    if (!part.shown || !part.triangles) return;
    const x = metres(part, frame);
    part.corners ||= [...new Set(part.index)];
    for (const i of part.corners) {
      const at = project(camera, canvas, vertexPlace(x, i)), away = Math.hypot(at.x - pointer.x, at.y - pointer.y);
      if (away < grabReach && at.depth > 0) found.push({ part, body, vertex: i, away, ...at });
    }
  });
  const front = Math.min(...found.map((v) => v.depth)) + 0.03 * camera.radius;
  found = found.filter((v) => v.depth <= front).sort((a, b) => a.away - b.away);
  return found[0];
}

/* Marks the vertex under the mouse; while it is held, draws a line to where it is pulled. */
class Grab {
  constructor(renderer, send) {
    Object.assign(this, { camera: renderer.camera, canvas: renderer.gl.canvas, send });
    $("legends").insertAdjacentHTML("beforebegin", '<svg id="grab"><line/><circle r="7"/></svg>');
    this.mark = $("grab");
    [this.line, this.ring] = this.mark.children;
    this.show();
    const listen = (name, act) => this.canvas.addEventListener(name, act, { capture: true });
    listen("pointerdown", (e) => this.begin(e));
    listen("pointermove", (e) => this.move(e));
    for (const name of ["pointerup", "pointercancel"]) listen(name, (e) => this.end(e));
    listen("pointerleave", () => this.held || this.hover(undefined));
  }
  pointer(e) {
    const { left, top } = this.canvas.getBoundingClientRect();
    return { x: e.clientX - left, y: e.clientY - top };
  }
  hover(vertex) {
    this.over = vertex;
    this.canvas.style.cursor = vertex ? "pointer" : "";
    this.show();
  }
  begin(e) {
    if (e.button || e.shiftKey || this.held || !player.following()) return;
    const vertex = pickVertex(this.camera, this.canvas, this.pointer(e), player.frame);
    if (!vertex) return;
    e.stopImmediatePropagation();
    this.canvas.setPointerCapture(e.pointerId);
    const start = vertexPlace(metres(vertex.part, player.frame), vertex.vertex);
    this.held = { ...vertex, id: e.pointerId, start, target: start, from: this.pointer(e) };
    this.pull();
    this.hover(vertex);
  }
  move(e) {
    const held = this.held;
    if (!held) {
      if (!e.buttons) this.hover(player.following() && pickVertex(this.camera, this.canvas, this.pointer(e), player.frame));
      return;
    }
    if (held.id !== e.pointerId) return;
    e.stopImmediatePropagation();
    /* The target moves in the plane through the vertex that is parallel to the picture. */
    const { right, up } = this.camera.axes(), to = this.pointer(e);
    const scale = 2 * held.depth * Math.tan(this.camera.field / 2) / this.canvas.clientHeight;
    held.target = held.start.map((v, k) =>
      v + scale * ((to.x - held.from.x) * right[k] - (to.y - held.from.y) * up[k]));
    this.pull();
    this.show();
  }
  pull() {
    this.send({ do: "hold", particle: meta.live.first[this.held.body] + this.held.vertex, target: this.held.target });
  }
  end(e) {
    if (this.held?.id !== e.pointerId) return;
    e.stopImmediatePropagation();
    this.held = undefined;
    this.send({ do: "release" });
    this.hover(undefined);
  }
  /* Draws the mark where the vertex is in the frame that is shown. */
  show() {
    const vertex = this.held || this.over;
    this.mark.style.display = vertex ? "" : "none";
    if (!vertex) return;
    const at = project(this.camera, this.canvas, vertexPlace(metres(vertex.part, player.frame), vertex.vertex));
    const to = this.held ? project(this.camera, this.canvas, this.held.target) : at;
    for (const [shape, values] of [[this.ring, { cx: at.x, cy: at.y }], [this.line, { x1: at.x, y1: at.y, x2: to.x, y2: to.y }]])
      for (const name in values) shape.setAttribute(name, values[name]);
  }
}
