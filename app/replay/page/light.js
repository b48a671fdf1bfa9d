/* Light: a studio with a soft sky and one lamp, which bodies and solids shade, and the shadow maps. */

/* GLSL that all programs share: positions, the cut, depths and the coding of colours. Targets hold colours as the
 * screen shows them (gamma 2, highlights compressed), shaders compute with linear light. */
const commonText = `
uniform mat4 view, projection;
uniform vec3 origin, size; /* box of the quantised positions, m */
uniform vec4 cut;          /* points p with cut.xyz p > cut.w are cut away */
uniform vec3 eye;
vec3 place(vec3 x) { return origin + size * x; }
/* Eye-space z of a value of the depth buffer, and the reverse. */
float eyeDepth(float depth) { return -projection[3][2] / (2.0 * depth - 1.0 + projection[2][2]); }
float bufferDepth(float z) { return 0.5 - 0.5 * (projection[2][2] + projection[3][2] / z); }
/* Powers by squaring: software renderers are slow at pow and exp. */
float power4(float x) { return x * x * x * x; }
float power32(float x) { return power4(power4(x)) * power4(power4(x)); }
vec3 compress(vec3 light) {
  vec3 over = max(light - 0.6, 0.0);
  return min(light, 0.6) + over / (1.0 + over / 0.4);
}
/* Each channel for itself would turn bright sand to lemon, all alike would tint highlights: the mean of both. */
vec3 encode(vec3 light) {
  float most = max(light.r, max(light.g, light.b));
  return sqrt(0.5 * (compress(light) + light * compress(vec3(most)) / max(most, 1e-6)));
}
vec3 mapColour(sampler2D map, float place) {
  vec3 c = texture(map, vec2(clamp(place, 0.0, 1.0) * 0.996 + 0.002, 0.5)).rgb;
  return c * c;
}
`;

const glslVector = (v) => `vec3(${v.join(", ")})`;

/* GLSL of lit materials. Colours are linear light. */
const lightText = commonText + `
uniform vec3 lamp;      /* lamp: unit vector towards it */
uniform mat4 lampView, skyView; /* world to texture coordinates of the shadow maps, of the map from above */
uniform float texel;    /* of the shadow map of what is opaque, m */
uniform float soft;     /* 0: few samples of the shadow maps, for speed */
uniform sampler2DShadow shadowMap, waterMap, skyMap;
uniform vec3 absorbed[3], scattered[3]; /* of three liquids, per length "clear" of water.js */
const vec3 up = ${glslVector(fromYUp([0, 1, 0]))};
const vec3 groundAxis = ${glslVector(fromYUp([0, 0, 1]))}; /* of the ground, beside x */
const vec3 softBox = normalize(${glslVector(fromYUp([-0.55, 0.7, -0.45]))});
const vec3 lampColour = vec3(1.16, 1.11, 1.04);
float unshaded(sampler2DShadow map, vec3 q) {
  float sum = texture(map, q), step = 1.3 / float(textureSize(map, 0).x);
  if (soft == 0.0) return sum;
  sum += texture(map, q + vec3(step, 0.5 * step, 0)) + texture(map, q - vec3(step, 0.5 * step, 0));
  sum += texture(map, q + vec3(-0.5 * step, step, 0)) + texture(map, q - vec3(-0.5 * step, step, 0));
  return 0.2 * sum;
}
/* The same with a penumbra: a disc of samples in a spiral. width: of the disc, as a part of the map */
float unshadedWide(sampler2DShadow map, vec3 q, float width) {
  if (soft == 0.0) return unshaded(map, q);
  float sum = 0.0;
  for (int k = 0; k < 32; k++) {
    float angle = 2.39996 * float(k), away = width * sqrt((float(k) + 0.5) / 32.0);
    sum += texture(map, q + vec3(away * vec2(cos(angle), sin(angle)), 0));
  }
  return sum / 32.0;
}
vec3 inLampView(vec3 p, vec3 n) { return (lampView * vec4(p + 2.0 * texel * n + 1.5 * texel * lamp, 1)).xyz; }
/* What a shadow of the first liquid lets through */
vec3 liquidShade() { return exp(-0.32 * absorbed[0]); }
/* Light of the lamp that reaches a point: bodies and solids shade it, water tints it. */
vec3 lampLight(vec3 p, vec3 n) {
  vec3 q = inLampView(p, n);
  if (any(greaterThan(abs(q - 0.5), vec3(0.5)))) return lampColour;
  return lampColour * unshaded(shadowMap, q) * mix(liquidShade(), vec3(1), unshaded(waterMap, q));
}
/* Light of the whole sky, and of the floor, on a surface with the normal n */
vec3 openSky(vec3 n) { return mix(vec3(0.15, 0.135, 0.125), vec3(0.33, 0.37, 0.43), 0.5 + 0.5 * dot(n, up)); }
/* The same at a point: bodies and solids hide as much of the sky as they cover of a cone of 45 degrees above the point. */
vec3 skyLight(vec3 p, vec3 n) {
  const int samples = 32;
  vec3 q = (skyView * vec4(p + 8.0 * texel * n + 8.0 * texel * up, 1)).xyz;
  float sum = 0.0;
  if (soft == 0.0) return 0.85 * openSky(n);
  for (int k = 0; k < samples; k++) {
    float angle = 2.39996 * float(k), away = 0.16 * (float(k) + 0.5) / float(samples);
    sum += texture(skyMap, q + away * vec3(cos(angle), sin(angle), -0.25)); /* depths: see Shadows */
  }
  return mix(0.45, 1.0, sum / float(samples)) * openSky(n);
}
/* Light from a direction: floor, horizon, sky, and a large soft box overhead. */
vec3 environment(vec3 d) {
  vec3 sky = mix(vec3(0.62, 0.67, 0.72), vec3(0.24, 0.38, 0.56), smoothstep(0.0, 0.75, dot(d, up)));
  float box = smoothstep(0.74, 0.86, dot(d, softBox));
  return mix(vec3(0.42, 0.41, 0.40), sky + 1.1 * box, smoothstep(-0.12, 0.08, dot(d, up)));
}
float fresnel(float cosine) {
  float rest = 1.0 - clamp(cosine, 0.0, 1.0);
  return 0.02 + 0.98 * power4(rest) * rest;
}
/* A matt surface at p with a weak gloss. light: of the lamp; n, toEye: unit vectors */
vec3 matt(vec3 colour, vec3 light, vec3 p, vec3 n, vec3 toEye) {
  float gloss = power32(max(dot(n, normalize(lamp + toEye)), 0.0));
  return colour * (skyLight(p, n) + light * max(dot(n, lamp), 0.0)) + 0.06 * gloss * light;
}
`;

/* Unit vector towards the lamp, with y up. */
const lampYUp = (() => {
  const d = [0.5, 0.78, 0.38], length = Math.hypot(...d);
  return d.map((v) => v / length);
})();

/* The shadow maps: depths of what is opaque and of water, seen from the lamp, and of what is opaque, seen from above.
 * They cover a sphere around the bounds of the view; outside of it there are no shadows. A map is 2 reach wide and
 * 4 times as deep. */
class Shadows {
  constructor(gl, camera) {
    this.gl = gl;
    [this.opaque, this.water, this.above] = [0, 1, 2].map(() => new Target(gl, null, true, gl.LINEAR));
    for (const { depth } of [this.opaque, this.water, this.above]) {
      gl.bindTexture(gl.TEXTURE_2D, depth);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    }
    this.reach = 1.3 * camera.radius;
    this.lamp = this.aim(camera.centre, viewAxes(Math.atan2(lampYUp[0], lampYUp[2]), Math.asin(lampYUp[1])));
    this.sky = this.aim(camera.centre, viewAxes(0, Math.PI / 2));
  }
  /* View and projection of a map, and world to its texture coordinates. */
  aim(centre, axes) {
    const view = viewMatrix(axes, centre), s = 1 / this.reach, depth = 1 / (4 * this.reach);
    const projection = new Float32Array([s, 0, 0, 0, 0, s, 0, 0, 0, 0, -depth, 0, 0, 0, 0, 1]);
    const rows = [0, 1, 2].map((i) => [0, 1, 2, 3].map((j) =>
      0.5 * [s, s, -depth][i] * view[4 * j + i] + (j === 3 ? 0.5 : 0)));
    return { view, projection, inMap: new Float32Array([0, 1, 2, 3].flatMap((j) => [...rows.map((row) => row[j]), j === 3 ? 1 : 0])) };
  }
  /* Values of the uniforms of lightText. size: of the maps, pixels */
  values(size) {
    return {
      lamp: fromYUp(lampYUp), texel: 2 * this.reach / size, lampView: this.lamp.inMap, skyView: this.sky.inMap,
      shadowMap: this.opaque.depth, waterMap: this.water.depth, skyMap: this.above.depth,
    };
  }
}
