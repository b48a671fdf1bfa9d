/* Fluids as a smooth surface, in screen space:
 *   depth     nearest point of the balls around the particles at each pixel (eye-space z)
 *   smooth    bilateral filter across and down, twice, then along both diagonals: the line that fits the depths on
 *             both sides best, so that a slope stays what it is at rims, too
 *   thickness volumes of the particles, spread over wider discs; near the surface the channel's value, or the
 *             number of the fluid's colour
 *   normals   from differences of the smooth depth
 *   compose   refraction, absorption, reflection; also of meshes (water_mesh.js)
 * Balls have 1.5 particle radii where the fluid is dense, so that no gaps stay between them, and less at its rims.
 * Particles that are alone are drops (drops.js). */
const waterText = {
  depth: `${ballHead}
uniform vec2 window;
out float result;
/* Factor on the distance of a ball's point from the eye that brings it to the wall of the vessel, if it is outside
 * in front of the wall; 0: the ray leaves nothing of the ball inside. */
float toWall(vec3 p, float depth) {
  vec3 ray = inWorld(p) - eye, a = (vesselLow - eye) / ray, b = (vesselHigh - eye) / ray;
  vec3 low = min(a, b), high = max(a, b);
  float enter = max(low.x, max(low.y, low.z)), leave = min(high.x, min(high.y, high.z));
  return leave < 1.0 || enter > leave || enter > 1.0 + depth / -p.z ? 0.0 : max(1.0, enter);
}
void main() {
  vec2 d = 2.0 * gl_PointCoord - 1.0;
  float square = dot(d, d);
  if (square > 1.0 || centre.z < eyeDepth(texture(sceneDepth, gl_FragCoord.xy / window).r)) discard;
  float bulge = r * sqrt(1.0 - square);
  vec3 p = vec3(centre.xy + r * vec2(d.x, -d.y), centre.z + bulge);
  float factor = inside > 0.0 ? toWall(p, 2.0 * bulge) : 1.0;
  if (factor == 0.0) discard;
  result = p.z * factor;
  gl_FragDepth = bufferDepth(result);
}`,
  smooth: `
in vec2 uv;
uniform sampler2D depths;
uniform vec2 direction;       /* pixels */
uniform float height, radius; /* radius: of the particles, m */
uniform float spread;         /* half-width of the filter in particle radii */
out float result;
const int taps = 12;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(depths, 0) - 1;
  float z = texelFetch(depths, at, 0).r;
  result = z;
  if (z == 0.0) return;
  float reach = clamp(0.5 * spread * radius * projection[1][1] * height / -z, 1.0, 3.0 * float(taps));
  float step = max(1.0, reach / float(taps));
  vec3 weights = vec3(1, 0, 0); /* sums of weights, times the place, times its square */
  vec2 sums = vec2(z, 0);       /* of weights times the depth, times the place */
  for (int k = 1; k <= taps; k++) {
    float place = float(k) * step / reach;
    if (place > 1.001) break;
    ivec2 away = ivec2(round(float(k) * step * direction));
    vec2 v = vec2(texelFetch(depths, clamp(at + away, ivec2(0), last), 0).r,
                  texelFetch(depths, clamp(at - away, ivec2(0), last), 0).r);
    float bell = 1.0 - 0.9 * place * place;
    float bend = v.x == 0.0 || v.y == 0.0 ? 1e9 : 0.5 * abs(v.x + v.y - 2.0 * z); /* 0 on a slope, steep or not */
    vec2 near = 1.0 - smoothstep(2.0 * radius, 6.0 * radius, abs(v - z));
    vec2 w = bell * bell * max(near, 1.0 - smoothstep(radius, 3.0 * radius, bend));
    weights += vec3(w.x + w.y, place * (w.x - w.y), place * place * (w.x + w.y));
    sums += vec2(dot(w, v), place * (w.x * v.x - w.y * v.y));
  }
  float spread = weights.x * weights.z - weights.y * weights.y;
  if (spread > 0.0) result = (weights.z * sums.x - weights.y * sums.y) / spread;
}`,
  thickness: `${ballHead}
uniform sampler2D depths;
uniform vec2 window;
uniform float parts; /* particles that this one stands for */
uniform float mapped, liquid; /* liquid: number of the fluid's colour */
out vec4 result;
void main() {
  vec2 d = 2.0 * gl_PointCoord - 1.0, uv = gl_FragCoord.xy / window;
  float bell = 1.0 - dot(d, d);
  if (bell < 0.0 || centre.z < eyeDepth(texture(sceneDepth, uv).r)) discard;
  float front = texture(depths, uv).r, volume = 8.0 * radius * radius * radius;
  float deep = front == 0.0 ? 0.0 : max(0.0, front - centre.z); /* 0: no ball; finer pixels have one */
  float weight = bell * power4(max(0.0, 1.0 - 0.25 * deep / radius));
  result = vec4(parts * volume / (0.25 * 3.14159 * r * r) * bell * bell * 0.75, weight * (mapped > 0.0 ? shade : liquid), weight, 0);
}`,
  normals: `
in vec2 uv;
uniform sampler2D depths;
uniform float distance, extent; /* of the eye from the target, m; unit of the depths in the result, m */
out vec4 result;
vec3 point(ivec2 at, float z) {
  vec2 ndc = 2.0 * (vec2(at) + 0.5) / vec2(textureSize(depths, 0)) - 1.0;
  return vec3(-z * ndc / vec2(projection[0][0], projection[1][1]), z);
}
/* Difference of points along an axis, towards the neighbour at the more similar depth. */
vec3 along(ivec2 at, ivec2 side, vec3 p) {
  float a = texelFetch(depths, at + side, 0).r, b = texelFetch(depths, at - side, 0).r;
  bool forward = b == 0.0 || a != 0.0 && abs(a - p.z) < abs(b - p.z);
  if (a == 0.0 && b == 0.0) return vec3(side, 0);
  return forward ? point(at + side, a) - p : p - point(at - side, b);
}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float z = texelFetch(depths, at, 0).r;
  result = vec4(0);
  if (z == 0.0) return;
  vec3 p = point(at, z), n = normalize(cross(along(at, ivec2(1, 0), p), along(at, ivec2(0, 1), p)));
  result = vec4(n.xy, (z + distance) / extent, 1);
}`,
  compose: `
in vec2 uv;
uniform sampler2D cover, thick, scene, sceneDepth, map;
uniform float distance, extent, radius, clear, mapped; /* clear: length, m, over which water gets its colour */
uniform float isWater; /* 1: the first liquid is water, without a colour of its own */
uniform float exact; /* 1: cover and thick are those of meshes */
out vec4 result;
/* Mean slope of the points around, one particle radius away; how even the water is there, 0...1: less where slopes
 * differ and where few points are near; the same, 0 at rims and steps of the depth, too. Uneven water does not shine,
 * and rims do not refract: what is beside them would appear in them. */
vec4 around(vec4 s, float z, vec2 scale) {
  vec2 slope = s.rg / s.a, rise = slope / sqrt(max(1.0 - dot(slope, slope), 0.01));
  if (soft == 0.0 || exact > 0.0) return vec4(slope, 1, 1);
  float tolerance = radius * (1.0 + min(length(rise), 3.0));
  vec4 sum = vec4(slope, 1, dot(slope, slope)); /* of slopes, of weights, of squares */
  for (int k = 0; k < 8; k++) {
    vec2 side = radius * vec2(cos(0.785398 * float(k)), sin(0.785398 * float(k)));
    vec4 t = texture(cover, uv + 0.5 * side * scale / -z);
    float away = abs((t.b / max(t.a, 1e-3) - s.b / s.a) * extent + dot(rise, side));
    float weight = 1.0 - smoothstep(tolerance, 2.0 * tolerance, away);
    sum += weight * vec4(t.rg, t.a, dot(t.rg, t.rg));
  }
  slope = sum.rg / sum.b;
  float alike = 1.0 - smoothstep(0.05, 0.6, sum.a / sum.b - dot(slope, slope)), near = (sum.b - 1.0) / 8.0;
  return vec4(slope, alike * smoothstep(0.0, 0.5, near), alike * smoothstep(0.45, 0.95, near));
}
/* Sums over the fluid behind a point of the window; .r: its thickness, m */
vec4 column(vec2 at) {
  vec4 sums = texture(thick, at);
  sums.r -= sums.a * (eyeDepth(texture(sceneDepth, at).r) + distance);
  return sums;
}
/* The point on the window where the refracted ray meets the scene; closer to uv where it meets what is just behind the
 * water's surface, and uv where that is in front of it, or where it is so much farther away than what the ray at uv
 * meets that it belongs to something else: the floor beside a cloth would appear as a hole in the cloth. */
vec2 refracted(vec2 slope, float z, float gap, vec2 scale) {
  float length = min(min(column(uv).r, 0.5 * clear), gap);
  vec2 there = clamp(uv - 0.16 * slope * length * scale / -z, vec2(0.002), vec2(0.998));
  float deep = z - eyeDepth(texture(sceneDepth, there).r), far = gap + 4.0 * radius;
  return mix(uv, there, smoothstep(0.0, 4.0 * radius, deep) * (1.0 - smoothstep(far, 2.0 * far, deep)));
}
/* Share of light that passes water before something in a vivid colour: all colours alike, otherwise red under water, which
 * absorbs red, would be black. */
vec3 clearPass(vec3 pass, vec3 behind) {
  float low = min(behind.r, min(behind.g, behind.b)), high = max(behind.r, max(behind.g, behind.b));
  return mix(pass, vec3(sqrt(max(pass.r, max(pass.g, pass.b)))), smoothstep(0.5, 0.9, 1.0 - low / max(high, 1e-3)));
}
/* Light from behind that passes the liquid, and light that it scatters. kind: its number, or one between two. Drops and
 * the edges of a tank would be clear; from a particle's radius on, meshes have the colour of a thicker layer. */
vec3 bodyColour(vec2 there, float thickness, float kind, vec3 light) {
  int k = int(min(kind, 1.0));
  float part = clamp(kind - float(k), 0.0, 1.0);
  float more = exact > 0.0 ? 0.35 * clear * (1.0 - exp(-thickness / radius)) : 0.0;
  vec3 x = (thickness + more) / clear * mix(absorbed[k], absorbed[k + 1], part), behind = texture(scene, there).rgb;
  vec3 pass = 1.0 / (1.0 + x * (1.0 + x * (0.5 + x / 6.0))); /* about exp(-x) */
  behind *= behind;
  pass = mix(pass, clearPass(pass, behind), isWater * max(1.0 - kind, 0.0));
  return behind * pass + mix(scattered[k], scattered[k + 1], part) * light * (1.0 - pass);
}
/* What a ray from the eye-space point q meets among what is in the window, or the sky: screen-space reflection in steps
 * that grow. A step that ends behind something by more than its length has passed behind it. */
vec3 traced(vec3 q, vec3 mirror, vec2 scale) {
  vec3 direction = mat3(view) * mirror;
  float noise = fract(52.98 * fract(dot(gl_FragCoord.xy, vec2(0.0671, 0.00584)))); /* interleaved gradient noise */
  float before = 0.0, reach = radius * (0.9 + 0.2 * noise);
  for (int k = 0; k < 24 && q.z + reach * direction.z < -1e-3; k++, before = reach, reach *= 1.2) {
    vec3 at = q + reach * direction;
    vec2 there = 0.5 + 0.5 * at.xy * scale / -at.z;
    if (any(greaterThan(abs(there - 0.5), vec2(0.5)))) break;
    float behind = eyeDepth(texture(sceneDepth, there).r) - at.z;
    if (behind > 0.0 && behind < radius + 1.5 * (reach - before) * abs(direction.z)) {
      vec3 met = texture(scene, there).rgb;
      return met * met;
    }
  }
  return environment(mirror);
}
/* lit: share of the lamp's light, whose highlight is left out where the water is uneven */
vec3 mirrored(vec3 q, vec3 n, vec3 toEye, vec2 scale, float lit) {
  vec3 mirror = reflect(-toEye, n);
  float gleam = power4(power32(max(dot(mirror, lamp), 0.0)));
  return traced(q, mirror, scale) * fresnel(dot(n, toEye)) + lit * gleam * gleam;
}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 s = texture(cover, uv);
  float back = texelFetch(sceneDepth, at, 0).r, z = s.b / max(s.a, 1e-3) * extent - distance;
  float gap = z - eyeDepth(back);
  result = texelFetch(scene, at, 0);
  gl_FragDepth = back;
  if (s.a < 0.1 || gap < 0.0) return;
  gl_FragDepth = bufferDepth(z);
  vec2 scale = vec2(projection[0][0], projection[1][1]);
  vec4 mean = around(s, z, scale);
  vec2 slope = mix(0.4, 1.0, mean.z) * mean.xy, there = refracted(mean.w * slope, z, gap, scale);
  vec3 n = vec3(slope, sqrt(max(1.0 - dot(slope, slope), 0.0))) * mat3(view);
  vec3 q = vec3(-z * (2.0 * uv - 1.0) / scale, z), p = (q - view[3].xyz) * mat3(view), toEye = normalize(eye - p);
  vec4 sums = column(there);
  float lit = unshaded(shadowMap, inLampView(p, n));
  vec3 light = openSky(n) + lampColour * lit * max(dot(n, lamp), 0.0);
  float value = sums.g / max(sums.b, 1e-4);
  vec3 body = mapped > 0.0 ? mapColour(map, value) * light : bodyColour(there, sums.r, value, light);
  float shine = smoothstep(0.0, 2.0 * radius, sums.r) * mean.z * (mapped > 0.0 ? 0.35 : 1.0);
  float opacity = smoothstep(0.2, 0.7, s.a) * smoothstep(0.3 * radius, 1.2 * radius, column(uv).r);
  if (exact > 0.0) shine = opacity = 1.0;
  body *= 1.0 - shine * fresnel(dot(n, toEye));
  result.rgb = mix(result.rgb, encode(body + shine * mirrored(q, n, toEye, scale, lit * power4(mean.z))), opacity);
}`,
};

class Water {
  constructor(gl) {
    this.gl = gl;
    this.programs = {
      depth: compile(gl, commonText + dropsLeftOut, ballVertex, waterText.depth),
      thickness: compile(gl, commonText + dropsLeftOut, ballVertex, waterText.thickness),
      smooth: compile(gl, commonText, tileVertex, waterText.smooth),
      normals: compile(gl, commonText, tileVertex, waterText.normals),
      compose: compile(gl, lightText, tileVertex, waterText.compose),
    };
    this.tiles = new Tiles(gl);
    this.depth = new Target(gl, "number", true);
    this.smoothed = [new Target(gl, "number", false), new Target(gl, "number", false)];
    this.thickness = new Target(gl, "sums", false);
    this.cover = new Target(gl, "sums", false);
  }
  drawDepth(bodies, values, width, height) {
    this.depth.begin(width, height);
    const images = values.soft ? 2 : 0;
    for (const body of bodies) body.draw(this.programs.depth, { ...values, height, window: [width, height] }, false, images);
  }
  /* Returns the texture of smooth depths. */
  smooth(values, width, height, count) {
    const diagonal = Math.SQRT1_2;
    const passes = [[[1, 0], 3.5], [[0, 1], 3.5], [[1, 0], 2], [[0, 1], 2], [[diagonal, diagonal], 1], [[diagonal, -diagonal], 1]];
    let depths = this.depth.colour;
    passes.slice(0, count).forEach(([direction, spread], k) => {
      this.smoothed[k % 2].begin(width, height);
      this.tiles.draw(this.programs.smooth, { ...values, height, depths, direction, spread });
      depths = this.smoothed[k % 2].colour;
    });
    return depths;
  }
  /* sparse: one particle of four, with the volume of four */
  drawThickness(bodies, values, width, height, sparse) {
    const gl = this.gl, own = { ...values, height, window: [width, height], depths: this.depth.colour };
    this.thickness.begin(width, height);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    for (const body of bodies)
      body.draw(this.programs.thickness, { ...own, liquid: body.liquid, shrink: sparse ? 2.2 : 1.7, parts: sparse ? 4 : 1 }, sparse);
    gl.disable(gl.BLEND);
  }
  /* Draws the passes before compose at a size in pixels. stage: called after each with its name */
  prepare(bodies, values, [width, height], level, stage) {
    this.drawDepth(bodies, values, width, height);
    stage("water depth");
    const depths = this.smooth(values, width, height, level.soft ? 6 : 4);
    stage("water filter");
    const canvas = level.soft ? values.window : [width, height]; /* fine enough for edges of cloth under water */
    this.drawThickness(bodies, values, Math.ceil(canvas[0] / 2), Math.ceil(canvas[1] / 2), !level.soft);
    stage("water thickness");
    this.cover.begin(width, height);
    this.tiles.draw(this.programs.normals, { ...values, depths });
    stage("water normals");
  }
  /* Draws the water over a copy of the scene. values: with cover and thick, from prepare() here or of MeshedWater */
  compose(values, scene, image) {
    const gl = this.gl, { width, height } = scene;
    image.begin(width, height);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, scene.framebuffer);
    const both = gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT;
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, both, gl.NEAREST);
    gl.depthFunc(gl.ALWAYS);
    this.tiles.draw(this.programs.compose, values);
    gl.depthFunc(gl.LEQUAL);
  }
}
