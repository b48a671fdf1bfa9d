/* Drops: particles of a fluid with no more than one neighbour, as small balls. A ball of water is a lens that turns the
 * picture behind it upside down; its rim is dark, because light comes there from far aside. */
const dropText = `${ballHead}
uniform sampler2D scene, map, cover;
uniform vec2 window;
uniform float mapped, liquid;
out vec4 result;
/* Light from behind. n: normal in eye space; nothing in front of the drop is taken for what is behind */
vec3 behind(vec3 n, float z) {
  vec2 here = gl_FragCoord.xy / window, scale = vec2(projection[0][0], projection[1][1]);
  vec2 there = clamp(here + 1.25 * r * n.xy * scale / z, vec2(0.002), vec2(0.998));
  vec3 colour = texture(scene, eyeDepth(texture(sceneDepth, there).r) < z ? there : here).rgb;
  vec3 tint = exp(-0.16 * absorbed[int(liquid)]);
  return colour * colour * tint * mix(1.0, 0.35, power4(1.0 - n.z * n.z));
}
void main() {
  vec2 d = 2.0 * gl_PointCoord - 1.0;
  float square = dot(d, d);
  if (square > 1.0) discard;
  vec3 n = vec3(d.x, -d.y, sqrt(1.0 - square)), side = n * mat3(view), p = inWorld(centre) + r * side;
  vec3 toEye = normalize(eye - p), light = lampLight(p, side);
  float z = centre.z + r * n.z, gloss = power32(max(dot(side, normalize(lamp + toEye)), 0.0));
  gl_FragDepth = bufferDepth(z);
  vec3 body = mapped > 0.0 ? matt(mapColour(map, shade), light, p, side, toEye) : behind(n, z);
  vec3 mirror = 0.4 * environment(reflect(-toEye, side)) * fresnel(n.z);
  result = vec4(encode(body + (mapped > 0.0 ? 0.35 : 1.0) * mirror + 0.8 * gloss * light), 1);
  float inWater = step(0.5, texture(cover, gl_FragCoord.xy / window).a) * (1.0 - mapped);
  result.a = 1.0 - inWater * (0.8 - 0.6 * gloss); /* the scene of the lens is without water */
}`;

class Drops {
  constructor(gl) {
    this.gl = gl;
    this.program = compile(gl, lightText + dropsAlone, ballVertex, dropText);
  }
  draw(bodies, values) {
    const gl = this.gl;
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ZERO, gl.ONE);
    for (const body of bodies) body.draw(this.program, { ...values, liquid: body.liquid });
    gl.disable(gl.BLEND);
  }
}
