/* Springs between bodies (attachments) as lines: "strings" of report.json. */
class Strings {
  constructor(gl) {
    const named = (name) => meta.bodies.find((part) => part.name === name);
    this.gl = gl;
    this.lines = new Lines(gl);
    const acts = ({ from, until }) => (time) => time >= from && (until === undefined || time <= until);
    this.groups = (meta.strings || [])
      .map((entry) => ({ from: named(entry.body), to: named(entry.to), acts: acts(entry), ends: entry.ends }))
      .filter(({ from, to }) => from && to && from.triangles && to.triangles);
  }
  upload(frame) {
    const ends = [];
    for (const { from, to, acts, ends: springs } of this.groups) {
      if (!from.shown || !to.shown || !acts(meta.times[frame])) continue;
      const x = metres(from, frame), y = metres(to, frame);
      for (const [vertex, a, b, c, ...weights] of springs) {
        const end = [0, 1, 2].map((k) => [a, b, c].reduce((sum, i, n) => sum + weights[n] * y[3 * i + k], 0));
        ends.push(...x.subarray(3 * vertex, 3 * vertex + 3), ...end);
      }
    }
    this.lines.upload(ends);
  }
  draw(programs, values) {
    const gl = this.gl;
    if (!this.lines.count) return;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.lines.draw(programs.edge, { ...values, width: 1.5 * values.width });
    gl.disable(gl.BLEND);
  }
}
