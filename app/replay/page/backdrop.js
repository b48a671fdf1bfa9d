/* The background and the ground: a light floor with shadows and a fine grid that fades into the background. */
const backdropText = {
  fragment: `
in vec2 uv;
out vec4 result;
void main() {
  result = vec4(mix(vec3(0.90, 0.91, 0.92), vec3(0.77, 0.81, 0.86), smoothstep(0.1, 1.0, uv.y)), 1);
}`,
  groundVertex: `
uniform vec3 centre;
uniform float reach;
out vec2 away;
out vec3 at;
void main() {
  away = 2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0;
  at = centre + reach * (away.x * vec3(1, 0, 0) + away.y * groundAxis);
  gl_Position = projection * view * vec4(at, 1);
}`,
  groundFragment: `
in vec2 away;
in vec3 at;
uniform float spacing;
out vec4 result;
float lines(float step) {
  vec2 p = vec2(at.x, dot(at, groundAxis)) / step, width = fwidth(p);
  vec2 d = abs(fract(p - 0.5) - 0.5) / width;
  return (1.0 - min(1.0, min(d.x, d.y))) * (1.0 - smoothstep(0.12, 0.4, max(width.x, width.y)));
}
/* As lampLight(), with shadows that have a penumbra. */
vec3 groundLight(vec3 n) {
  vec3 q = inLampView(at, n);
  if (any(greaterThan(abs(q - 0.5), vec3(0.5)))) return lampColour;
  float lit = unshadedWide(shadowMap, q, 0.012), dry = unshadedWide(waterMap, q, 0.012);
  return lampColour * lit * mix(liquidShade(), vec3(1), dry);
}
void main() {
  float distance = length(away), grid = max(0.05 * lines(spacing), 0.085 * lines(5.0 * spacing));
  vec3 colour = 0.66 * (1.4 * skyLight(at, up) + 0.93 * groundLight(up) * dot(lamp, up));
  grid *= 1.0 - smoothstep(0.15, 0.6, distance);
  result = vec4(encode(colour) * (1.0 - grid), 1.0 - smoothstep(0.3, 1.0, distance));
}`,
};

/* The largest of 1, 2, 5, 10, 20, ... times a power of ten that is at most `size`. */
function roundSpacing(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  return [5, 2, 1].find((k) => k * power <= size) * power;
}

class Backdrop {
  constructor(gl, camera, ground) {
    this.gl = gl;
    this.back = compile(gl, commonText, windowVertex, backdropText.fragment);
    this.ground = compile(gl, lightText, backdropText.groundVertex, backdropText.groundFragment);
    this.own = {
      centre: camera.centre.slice(), reach: 9 * camera.radius,
      spacing: roundSpacing(0.16 * camera.radius),
    };
    this.place(ground);
  }
  /* Moves the ground to a height, m. */
  place(height) {
    this.height = this.own.centre[vertical] = height;
  }
  drawBackground(values) {
    if (settings.background === "white") {
      this.gl.clearColor(1, 1, 1, 1);
      this.gl.clear(this.gl.COLOR_BUFFER_BIT);
      return;
    }
    this.gl.disable(this.gl.DEPTH_TEST);
    drawWindow(this.gl, this.back, values);
    this.gl.enable(this.gl.DEPTH_TEST);
  }
  /* After all that is opaque; nothing is drawn for an eye below the ground, or before white. */
  drawGround(values) {
    const gl = this.gl;
    if (values.eye[vertical] <= this.height || settings.background === "white") return;
    use(gl, this.ground, { ...values, ...this.own });
    gl.bindVertexArray(null);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }
}
