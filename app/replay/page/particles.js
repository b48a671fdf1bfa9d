/* Particles as balls: grains, boundary points, and fluids in the view of particles. */
const ballVertex = `
layout(location = 0) in vec3 x;
layout(location = 1) in float value; /* square root of a channel's value, 0...1 */
layout(location = 2) in float filled; /* square root of the share of the space around that the fluid fills */
uniform float radius, height, scale;
uniform float shrink; /* 0: all balls have the particle radius; else a factor on radii by the density around */
uniform vec3 vesselLow, vesselHigh;
out vec3 centre;
out float r, shade, inside; /* inside: the centre is in the vessel */
/* Instances 1 and 2 of a ball are its images in the nearest wall of the vessel along x and z, so that the water meets
 * the walls without gaps between balls. away: distance of the ball from that wall */
vec3 image(vec3 p, out float away) {
  int k = gl_InstanceID == 1 ? 0 : 2;
  float low = p[k] - vesselLow[k], high = vesselHigh[k] - p[k];
  away = gl_InstanceID == 0 ? 0.0 : min(low, high);
  if (gl_InstanceID > 0) p[k] += low < high ? -2.0 * low : 2.0 * high;
  return p;
}
void main() {
  float away;
  vec3 p = place(x);
  bool drop = filled * filled < 0.3;
  r = radius * (shrink == 0.0 ? 1.0 : shrink * (drop ? 0.6 : mix(0.9, 1.5, smoothstep(0.3, 0.62, filled * filled))));
  inside = all(greaterThan(p, vesselLow)) && all(lessThan(p, vesselHigh)) ? 1.0 : 0.0;
  vec4 at = view * vec4(image(p, away), 1);
  centre = at.xyz;
  shade = min(1.0, value * value * scale);
  gl_Position = projection * at;
  bool outside = gl_InstanceID > 0 && inside == 0.0;
  if (outside || away > r || dot(cut.xyz, p) > cut.w || leftOut(gl_Position, centre.z, drop)) gl_Position = vec4(2, 2, 2, 1);
  gl_PointSize = max(1.0, 1.04 * r * projection[1][1] * height / gl_Position.w);
}`;
const ballHead = `
in vec3 centre;
in float r, shade, inside;
uniform float radius, height, scale, shrink;
uniform vec3 vesselLow, vesselHigh;
vec3 inWorld(vec3 p) { return (p - view[3].xyz) * mat3(view); }
`;
/* Which balls a program leaves out. Water: drops, and balls whose centres are hidden by what is opaque, so that it does
 * not reach past the rim of a cloth that holds it; in the lamp's view, so that it does not shade that cloth. */
const noneLeftOut = `
bool leftOut(vec4 at, float z, bool drop) { return false; }
`, shadedLeftOut = `
uniform sampler2DShadow shadowMap;
bool leftOut(vec4 at, float z, bool drop) { return texture(shadowMap, 0.5 + 0.5 * at.xyz / at.w) < 0.5; }
`, hiddenText = `
uniform sampler2D sceneDepth;
bool hidden(vec4 at, float z) { return z < eyeDepth(texture(sceneDepth, 0.5 + 0.5 * at.xy / at.w).r); }
`, dropsLeftOut = hiddenText + `
bool leftOut(vec4 at, float z, bool drop) { return drop || hidden(at, z); }
`, dropsAlone = hiddenText + `
bool leftOut(vec4 at, float z, bool drop) { return !drop || hidden(at, z); }
`;
const ballText = {
  colour: `${ballHead}
uniform sampler2D map;
uniform vec4 plain; /* colour, and 1 to use it instead of the map */
out vec4 result;
void main() {
  vec2 d = 2.0 * gl_PointCoord - 1.0;
  float square = dot(d, d);
  if (square > 1.0) discard;
  vec3 n = vec3(d.x, -d.y, sqrt(1.0 - square)) * mat3(view), p = inWorld(centre) + r * n;
  gl_FragDepth = bufferDepth(centre.z + r * sqrt(1.0 - square));
  vec3 colour = mix(mapColour(map, shade), plain.rgb, plain.a);
  result = vec4(encode(matt(colour, lampLight(p, n), p, n, normalize(eye - p))), 1);
}`,
  shadow: `${ballHead}
void main() {
  vec2 d = 2.0 * gl_PointCoord - 1.0;
  float square = dot(d, d);
  if (square > 1.0) discard;
  vec3 at = vec3(centre.xy + r * vec2(d.x, -d.y), centre.z + r * sqrt(1.0 - square)), p = inWorld(at);
  if (inside > 0.0 && (any(lessThan(p, vesselLow)) || any(greaterThan(p, vesselHigh)))) discard;
  gl_FragDepth = 0.5 + 0.5 * (projection[2][2] * at.z + projection[3][2]); /* the lamp has no perspective */
}`,
};

/* The points of one part on the graphics card. */
class Points {
  constructor(gl, part) {
    Object.assign(this, { gl, part, scale: 0 });
    this.array = gl.createVertexArray();
    this.x = addAttribute(gl, this.array, 0, 3, gl.UNSIGNED_SHORT);
    if (!part.channels.length) return;
    this.value = addAttribute(gl, this.array, 1, 1, gl.UNSIGNED_BYTE);
    this.filled = addAttribute(gl, this.array, 2, 1, gl.UNSIGNED_BYTE);
    this.makeSparse();
  }
  /* Every fourth particle of the same buffers. */
  makeSparse() {
    const gl = this.gl;
    this.sparse = gl.createVertexArray();
    gl.bindVertexArray(this.sparse);
    [[this.x, 3, gl.UNSIGNED_SHORT, 24], [this.value, 1, gl.UNSIGNED_BYTE, 4], [this.filled, 1, gl.UNSIGNED_BYTE, 4]]
      .forEach(([buffer, parts, type, stride], location) => {
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.enableVertexAttribArray(location);
        gl.vertexAttribPointer(location, parts, type, true, stride, 0);
      });
  }
  upload(frame, channel) {
    const { gl, part } = this;
    this.count = pointsOf(part, frame);
    this.box = boxOf(part, frame);
    fillBuffer(gl, this.x, positions(part, frame));
    if (!this.value) return;
    this.scale = mostOf(part, channel, frame) / ranges[channel]?.top || 0;
    fillBuffer(gl, this.value, part[channel][frame]);
    fillBuffer(gl, this.filled, part.filled[frame]);
  }
  values() {
    const [low, high] = this.box, { scale, part: { radius } } = this;
    return { origin: low, size: high.map((v, k) => v - low[k]), radius, scale };
  }
  draw(program, values, sparse, images = 0) {
    use(this.gl, program, { ...values, ...this.values() });
    this.gl.bindVertexArray(sparse ? this.sparse : this.array);
    this.gl.drawArraysInstanced(this.gl.POINTS, 0, sparse ? Math.floor(this.count / 4) : this.count, 1 + images);
  }
}

class Balls {
  constructor(gl) {
    this.colour = compile(gl, lightText + noneLeftOut, ballVertex, ballText.colour);
    this.shadow = compile(gl, commonText + noneLeftOut, ballVertex, ballText.shadow);
    this.waterShadow = compile(gl, commonText + shadedLeftOut, ballVertex, ballText.shadow);
  }
}
