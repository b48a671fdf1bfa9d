/* Containers (tanks, vessels) as glass: faint reflecting faces, and lines along the edges. */
const glassText = {
  face: `
in vec3 n, at, cell;
in float shade;
uniform sampler2D cover; /* water in front of which this pass draws; alpha 0: none */
uniform float over;      /* 1: draw only over water */
uniform vec2 window;
out vec4 result;
void main() {
  if (dot(cut.xyz, at) > cut.w || over > 0.0 && texture(cover, gl_FragCoord.xy / window).a < 0.5) discard;
  vec3 toEye = normalize(eye - at), side = normalize(n);
  float cosine = abs(dot(side, toEye));
  side = dot(side, toEye) < 0.0 ? -side : side;
  float mirror = 0.035 + 0.30 * power4(1.0 - cosine);
  result = vec4(mirror * encode(environment(reflect(-toEye, side))) + 0.03 * vec3(0.78, 0.90, 0.87), mirror + 0.03);
}`,
  edgeVertex: `
layout(location = 0) in vec3 a;
layout(location = 1) in vec3 b;
uniform vec2 window;
uniform float width; /* pixels */
out vec3 at;
out float across; /* pixels from the middle of the line */
void main() {
  vec4 p = projection * view * vec4(a, 1), q = projection * view * vec4(b, 1);
  float near = 1e-3 * projection[3][2] / (projection[2][2] - 1.0);
  if (p.w < near) p = mix(p, q, (near - p.w) / (q.w - p.w));
  if (q.w < near) q = mix(q, p, (near - q.w) / (p.w - q.w));
  vec2 along = (q.xy / q.w - p.xy / p.w) * window;
  vec2 aside = vec2(-along.y, along.x) / max(length(along), 1e-6) * (width + 1.0) / window;
  bool end = (gl_VertexID & 1) == 1;
  gl_Position = end ? q : p;
  across = (gl_VertexID < 2 ? 0.5 : -0.5) * (width + 1.0);
  gl_Position.xy += (gl_VertexID < 2 ? aside : -aside) * gl_Position.w;
  at = end ? b : a;
}`,
  /* opaque: GLSL, whether something opaque is in front; share: how opaque the line is */
  edgeFragment: (opaque, share) => `
in vec3 at;
in float across;
uniform sampler2D sceneDepth;
uniform float width;
uniform vec2 window;
out vec4 result;
void main() {
  if (dot(cut.xyz, at) > cut.w || ${opaque}) discard;
  float strength = ${share} * clamp(0.5 * (width + 1.0) - abs(across), 0.0, 1.0);
  result = vec4(vec3(0.30, 0.40, 0.43) * strength, strength);
}`,
};

class GlassPrograms {
  constructor(gl) {
    this.face = compile(gl, lightText, surfaceVertex, glassText.face);
    this.edge = compile(gl, commonText, glassText.edgeVertex, glassText.edgeFragment("false", "0.75"));
    this.edgeBehind = compile(gl, commonText, glassText.edgeVertex,
      glassText.edgeFragment("gl_FragCoord.z > texture(sceneDepth, gl_FragCoord.xy / window).r", "0.2"));
  }
}

/* Straight lines, instances of pairs of points. */
class Lines {
  constructor(gl) {
    Object.assign(this, { gl, count: 0, array: gl.createVertexArray() });
    this.ends = addAttribute(gl, this.array, 0, 3, gl.FLOAT);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 24, 0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 3, gl.FLOAT, false, 24, 12);
    for (const k of [0, 1]) gl.vertexAttribDivisor(k, 1);
  }
  /* ends: six coordinates a line, m */
  upload(ends) {
    fillBuffer(this.gl, this.ends, Float32Array.from(ends));
    this.count = ends.length / 6;
  }
  draw(program, values) {
    use(this.gl, program, values);
    this.gl.bindVertexArray(this.array);
    this.gl.drawArraysInstanced(this.gl.TRIANGLE_STRIP, 0, 4, this.count);
  }
}

/* One container: its faces, and its edges as lines. */
class Glass extends Surface {
  constructor(gl, part) {
    super(gl, part);
    this.pairs = sharpEdges(metres(part, 0), part.index);
    this.lines = new Lines(gl);
  }
  upload(frame) {
    super.upload(frame);
    const x = metres(this.part, frame);
    this.lines.upload(this.pairs.flatMap((i) => [x[3 * i], x[3 * i + 1], x[3 * i + 2]]));
  }
  blended(draw) {
    const gl = this.gl;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(0, -4096); /* of 2^-24: in front of water and bodies that touch it */
    draw();
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }
  drawFaces(programs, values) {
    this.blended(() => this.draw(programs.face, values));
  }
  /* After the water, which does not refract them: a bent line looks like a crack. Faint ones behind water. */
  drawEdges(programs, values, behind) {
    const gl = this.gl;
    this.blended(() => this.lines.draw(programs.edge, values));
    if (!behind) return;
    gl.depthFunc(gl.GREATER);
    this.blended(() => this.lines.draw(programs.edgeBehind, values));
    gl.depthFunc(gl.LEQUAL);
  }
}
