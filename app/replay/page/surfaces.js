/* Cloth, soft bodies and opaque solids: triangles with two sides. */
const surfaceVertex = `
layout(location = 0) in vec3 x;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 checker;
layout(location = 3) in float value; /* 0...1 along the colour map */
out vec3 n, at, cell;
out float shade;
void main() {
  at = x;
  n = normal;
  cell = checker;
  shade = value;
  gl_Position = projection * view * vec4(x, 1);
}`;
const surfaceText = {
  colour: `
in vec3 n, at, cell;
in float shade;
uniform vec3 tint;
uniform float sheer, checked, mapped; /* sheer: light shines through; checked: size of the checks, m, 0 for none */
uniform sampler2D map;
out vec4 result;
vec3 pattern() {
  if (mapped > 0.0) return mapColour(map, shade);
  if (checked == 0.0) return gl_FrontFacing ? tint : mix(tint, vec3(0.6), 0.22);
  ivec3 k = ivec3(floor(cell / checked + 0.01));
  return (k.x + k.y + k.z & 1) == 0 ? tint : tint * vec3(0.36, 0.33, 0.36);
}
void main() {
  if (dot(cut.xyz, at) > cut.w) discard;
  vec3 toEye = normalize(eye - at), side = normalize(n) * (gl_FrontFacing ? 1.0 : -1.0), colour = pattern();
  float facing = dot(side, lamp);
  vec3 light = lampLight(at, facing > 0.0 ? side : -side);
  vec3 through = sheer * 0.25 * max(-facing, 0.0) * light * colour;
  float sheen = sheer * 0.3 * power4(1.0 - max(dot(side, toEye), 0.0));
  result = vec4(encode(matt(colour, light, at, side, toEye) + through + sheen * openSky(side)), 1);
}`,
  shadow: `
in vec3 n, at, cell;
in float shade;
void main() {
  if (dot(cut.xyz, at) > cut.w) discard;
}`,
};

/* Triangles of one part on the graphics card. Vertices are split at creases. */
class Surface {
  constructor(gl, part) {
    Object.assign(this, { gl, part }, splitCreases(metres(part, 0), part.index));
    this.array = gl.createVertexArray();
    [this.x, this.normal, this.checker] = [0, 1, 2].map((k) => addAttribute(gl, this.array, k, 3, gl.FLOAT));
    this.value = addAttribute(gl, this.array, 3, 1, gl.FLOAT);
    addIndices(gl, this.array, this.index);
    const x = this.gather(0);
    this.closed = isClosed(x, this.index);
    this.normals = new Float32Array(x.length);
    fillBuffer(gl, this.checker, checkerCoordinates(x, this.index, this.closed));
    this.measureRest(x);
  }
  gather(frame) {
    const x = metres(this.part, frame), out = new Float32Array(3 * this.source.length);
    for (let i = 0; i < out.length; i++) out[i] = x[3 * this.source[Math.floor(i / 3)] + i % 3];
    return out;
  }
  measureRest(x) {
    this.edges = [...new Set([...findEdges(x, this.index).keys()])].flatMap((key) => key.split(",").map(Number));
    this.same = weld(x);
    this.rest = Float32Array.from({ length: this.edges.length / 2 }, (_, e) => {
      const [a, b] = [this.edges[2 * e], this.edges[2 * e + 1]];
      return Math.hypot(...[0, 1, 2].map((k) => x[3 * a + k] - x[3 * b + k])) || 1;
    });
  }
  /* Values along the colour map, 0...1. range: of the channel */
  shades(frame, x, channel, range) {
    const out = new Float32Array(this.source.length);
    if (channel === "stretch") {
      const stretch = vertexStretch(this.edges, this.rest, x, new Float32Array(out.length));
      return out.map((_, i) => 0.5 + 0.5 * stretch[this.same[i]] / range.top);
    }
    const values = this.part[channel][frame];
    return out.map((_, i) => channelValue(this.part, channel, frame, values[this.source[i]]) / range.top);
  }
  upload(frame, channel, range) {
    const gl = this.gl, x = this.gather(frame);
    fillBuffer(gl, this.x, x);
    fillBuffer(gl, this.normal, sumNormals(x, this.index, this.normals));
    fillBuffer(gl, this.value, range ? this.shades(frame, x, channel, range) : new Float32Array(this.source.length));
  }
  draw(program, values) {
    const gl = this.gl;
    use(gl, program, values);
    gl.bindVertexArray(this.array);
    gl.drawElements(gl.TRIANGLES, this.index.length, gl.UNSIGNED_INT, 0);
  }
}

class Fabric {
  constructor(gl) {
    this.colour = compile(gl, lightText, surfaceVertex, surfaceText.colour);
    this.shadow = compile(gl, commonText, surfaceVertex, surfaceText.shadow);
  }
}

/* Range of the stretch of bodies in some frames: the largest value, and the 99.5 % quantile of its size. */
function measureStretch(shapes, frames) {
  const sizes = [];
  for (const shape of shapes) {
    if (!(shape instanceof Surface) || shape.solid) continue;
    for (const f of frames) {
      const x = shape.gather(f);
      const stretch = vertexStretch(shape.edges, shape.rest, x, new Float32Array(shape.source.length));
      for (const v of stretch) sizes.push(Math.abs(v));
    }
  }
  sizes.sort((a, b) => a - b);
  return { top: sizes[Math.floor(0.995 * sizes.length)] || 0.01, most: sizes[sizes.length - 1] || 0 };
}
