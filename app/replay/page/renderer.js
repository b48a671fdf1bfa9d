/* The order of the passes of one picture: shadow maps, what is opaque, glass, water, glass over water, and the
 * picture on the canvas with its edges smoothed. */
const finishText = `
in vec2 uv;
uniform sampler2D scene;
uniform float soft;
out vec4 result;
float luma(vec3 c) { return dot(c, vec3(0.299, 0.587, 0.114)); }
/* FXAA (Lottes 2009): blurs along edges of the brightness. */
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(scene, 0) - 1;
  result = texelFetch(scene, at, 0);
  if (soft == 0.0) return;
  float m = luma(result.rgb);
  float nw = luma(texelFetch(scene, clamp(at + ivec2(-1, 1), ivec2(0), last), 0).rgb);
  float ne = luma(texelFetch(scene, clamp(at + ivec2(1, 1), ivec2(0), last), 0).rgb);
  float sw = luma(texelFetch(scene, clamp(at - ivec2(1, 1), ivec2(0), last), 0).rgb);
  float se = luma(texelFetch(scene, clamp(at + ivec2(1, -1), ivec2(0), last), 0).rgb);
  float low = min(m, min(min(nw, ne), min(sw, se))), high = max(m, max(max(nw, ne), max(sw, se)));
  if (high - low < 0.04) return;
  vec2 d = vec2(sw + se - nw - ne, nw + sw - ne - se);
  d = clamp(d / (min(abs(d.x), abs(d.y)) + max(0.03 * (nw + ne + sw + se), 0.008)), -8.0, 8.0) / vec2(last + 1);
  vec3 near = 0.5 * (texture(scene, uv - d / 6.0).rgb + texture(scene, uv + d / 6.0).rgb);
  vec3 wide = 0.5 * near + 0.25 * (texture(scene, uv - 0.5 * d).rgb + texture(scene, uv + 0.5 * d).rgb);
  result.rgb = luma(wide) < low || luma(wide) > high ? near : wide;
}`;

/* Levels of quality: pixels of the canvas for one of the device; radius in pixels that a particle at the target has
 * in the water passes, which have at most the pixels of the canvas; size of the shadow maps; soft: edges of shadows
 * and of the picture are smoothed. The first is for pictures that stand still, the others keep the animation fluent
 * on slow machines. */
const levels = [
  { scale: 1, water: 5, shadow: 2048, soft: 1 },
  { scale: 1, water: 3, shadow: 1024, soft: 0 },
  { scale: 0.7, water: 2.2, shadow: 1024, soft: 0 },
  { scale: 0.5, water: 1.7, shadow: 512, soft: 0 },
  { scale: 0.35, water: 1.3, shadow: 256, soft: 0 },
];

/* The channel of particles that colours them; plain ones ignore it. */
const fluidChannel = () => settings.fluid in channels ? settings.fluid : "speed";

/* Of the first view, rad: from higher up where water lies in cloth, which would hide it. */
function firstPitch() {
  const cloth = meta.bodies.some((body) => body.triangles && body.kind !== "rigid");
  return cloth && meta.bodies.some((body) => body.fluid) ? 0.6 : 0.33;
}

class Renderer {
  constructor(gl) {
    this.gl = gl;
    if (!gl.getExtension("EXT_color_buffer_float"))
      throw new Error("This page needs a graphics driver with float render targets (EXT_color_buffer_float).");
    markLeavers();
    const bounds = meta.live ? guessBounds(measureBounds()) : measureBounds();
    this.groundHeight = groundHeight(bounds);
    this.camera = new Camera(includeGround(bounds, this.groundHeight), firstPitch());
    this.shadows = new Shadows(gl, this.camera);
    this.backdrop = new Backdrop(gl, this.camera, this.groundHeight - 0.002 * this.camera.radius);
    this.balls = new Balls(gl);
    this.fabric = new Fabric(gl);
    this.glass = new GlassPrograms(gl);
    this.water = new Water(gl);
    this.meshedWater = new MeshedWater(gl);
    this.drops = new Drops(gl);
    this.finish = compile(gl, "", windowVertex, finishText);
    this.scene = new Target(gl, "colour", true);
    this.image = new Target(gl, "colour", true);
    this.maps = {};
    for (const name in maps) this.maps[name] = this.makeMap(name);
    this.makeParts();
    this.strings = new Strings(gl);
    this.stage = () => {};
  }
  makeMap(name) {
    const gl = this.gl, texture = makeTexture(gl, gl.LINEAR), texels = new Uint8Array(mapTexels(maps[name]).buffer);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, texels);
    return texture;
  }
  /* Everything that is drawn: .part, and how. The order of meta.bodies gives colours to those without their own. */
  makeParts() {
    const gl = this.gl;
    this.parts = meta.bodies.map((part) => !part.triangles ? new Points(gl, part)
      : this.isCup(part) ? new Glass(gl, part) : new Surface(gl, part));
    this.tintBodies();
    for (const part of meta.solids) {
      const shape = this.isVessel(part) ? new Glass(gl, part) : new Surface(gl, part);
      this.parts.push(Object.assign(shape, { tint: ownColour(part, clay), solid: true }));
    }
    const vessel = this.parts.find((shape) => shape instanceof Glass && shape.part.rest && shape.part.kind === "box");
    const [vesselLow, vesselHigh] = vessel ? boxWalls(metres(vessel.part, 0), vessel.part.index, vessel.part.box)
      : boxWalls([], [], [0, 0]);
    this.vessel = { vesselLow, vesselHigh };
    for (const part of meta.boundary)
      this.parts.push(Object.assign(new Points(gl, part), { tint: linearColour(clay), solid: true }));
  }
  tintBodies() {
    const isSheet = (shape) => shape instanceof Surface && !shape.closed;
    const shapes = this.parts.filter((shape) => !shape.part.fluid), fluids = this.parts.filter((shape) => shape.part.fluid);
    fluids.forEach((shape, k) => {
      shape.liquid = k % palette.liquid.length;
      shape.tint = ownColour(shape.part, palette.liquid[shape.liquid]);
    });
    this.liquids = liquidLooks(fluids.map((shape) => shape.part));
    for (const [kind, colours] of [["sheet", palette.sheet], ["solid", palette.solid]])
      shapes.filter((shape) => isSheet(shape) === (kind === "sheet"))
        .forEach((shape, k) => { shape.tint = ownColour(shape.part, colours[k % colours.length]); });
  }
  /* Whether a solid is a container: a box with an open side, or around the middle of the bodies; a mesh around a body
   * that it hides from the first view at the start, in the middle or at the end. */
  isVessel(part) {
    const around = this.camera.centre.every((v, k) => v > part.box[0][k] && v < part.box[1][k]);
    if (part.kind === "box") return around || !isClosed(metres(part, 0), part.index);
    return this.hides(part, meta.bodies);
  }
  /* Whether a body is a container: a rigid one that hides a fluid. */
  isCup(part) {
    return part.kind === "rigid" && this.hides(part, meta.bodies.filter((body) => body.fluid));
  }
  hides(part, bodies) {
    const last = lastFrame(), { back } = this.camera.axes();
    return [...new Set([0, last >> 1, last])].some((f) => bodies.some((body) => hidesBody(part, body, f, back)));
  }
  upload(frame) {
    for (const shape of this.parts) {
      if (!shape.part.shown || shape.solid && shape.part.rest && shape.uploaded) continue;
      if (shape instanceof Points) shape.upload(frame, fluidChannel());
      else shape.upload(frame, settings.surface, shape.solid ? null : ranges[settings.surface]);
      shape.uploaded = true;
    }
    this.strings.upload(frame);
    this.uploaded = frame;
    this.stale = false;
  }
  /* What is drawn in which way. */
  sort() {
    const shown = this.parts.filter((shape) => shape.part.shown);
    const isWater = (shape) => shape.part.fluid && settings.look === "surface";
    return {
      water: shown.filter(isWater),
      balls: shown.filter((shape) => shape instanceof Points && !isWater(shape)),
      surfaces: shown.filter((shape) => shape instanceof Surface && !(shape instanceof Glass)),
      glass: shown.filter((shape) => shape instanceof Glass),
    };
  }
  drawOpaqueShadows(sorted, values) {
    for (const shape of sorted.surfaces) shape.draw(this.fabric.shadow, values);
    for (const shape of sorted.balls) shape.draw(this.balls.shadow, { ...values, shrink: 0 });
  }
  drawShadows(sorted, shared, { shadow: size, soft }) {
    const values = { ...shared, ...this.shadows.lamp, height: size };
    const low = { ...values, height: size / 4, shrink: soft ? 1 : 1.5, shadowMap: this.shadows.opaque.depth };
    this.shadows.opaque.begin(size, size);
    this.drawOpaqueShadows(sorted, values);
    this.shadows.water.begin(size / 4, size / 4);
    for (const shape of sorted.water) shape.draw(this.balls.waterShadow, low, !soft);
    this.shadows.above.begin(size / 8, size / 8);
    if (soft) this.drawOpaqueShadows(sorted, { ...values, ...this.shadows.sky, height: size / 8 });
  }
  ballLook(shape) {
    const plain = shape.solid || settings.fluid === "plain" ? [...shape.tint, 1] : [0, 0, 0, 0];
    return { plain, map: this.maps[channels[fluidChannel()].map], shrink: 0 };
  }
  surfaceLook(shape) {
    const channel = channels[settings.surface];
    return {
      tint: shape.tint, sheer: shape.closed ? 0 : 1, mapped: channel && !shape.solid ? 1 : 0,
      map: this.maps[channel ? channel.map : "mako"],
      checked: settings.surface === "checker" && !shape.solid ? this.checkSize(shape) : 0,
    };
  }
  /* A twelfth of the longest side of a body's box. */
  checkSize(shape) {
    shape.checkSize ||= Math.max(...shape.part.box[1].map((v, k) => v - shape.part.box[0][k])) / 12;
    return shape.checkSize;
  }
  drawScene(sorted, values) {
    for (const shape of sorted.surfaces) shape.draw(this.fabric.colour, { ...values, ...this.surfaceLook(shape) });
    for (const shape of sorted.balls) shape.draw(this.balls.colour, { ...values, ...this.ballLook(shape) });
    this.strings.draw(this.glass, values);
    this.backdrop.drawGround(values);
    for (const shape of sorted.glass) shape.drawFaces(this.glass, { ...values, over: 0 });
    if (!sorted.water.length) for (const shape of sorted.glass) shape.drawEdges(this.glass, values, false);
  }
  /* Draws the passes before water.compose, from meshes where all fluids have them. Returns this.meshedWater or
   * this.water, whose .cover and .thickness are the result. */
  prepareWater(fluids, values, level) {
    this.water.tiles.update(fluids, this.uploaded, values);
    if (drawsMeshes() && fluids.every((shape) => shape.mesh)) {
      this.meshedWater.prepare(fluids, values);
      return this.meshedWater;
    }
    const { width, height } = this.scene;
    const pixels = 0.5 * values.radius * values.projection[5] * height / this.camera.distance;
    const size = [width, height].map((side) => Math.ceil(side * Math.min(1, level.water / pixels)));
    this.water.prepare(fluids, values, size, level, this.stage);
    return this.water;
  }
  drawWater(sorted, values, level) {
    const own = {
      ...values, sceneDepth: this.scene.depth, scene: this.scene.colour, shrink: 1,
      radius: Math.max(...sorted.water.map((shape) => shape.part.radius)), map: this.maps[channels[fluidChannel()].map],
      mapped: settings.fluid === "plain" ? 0 : 1, clear: 0.35 * this.camera.radius,
      distance: this.camera.distance, extent: this.camera.radius,
    };
    const passes = this.prepareWater(sorted.water, own, level), cover = passes.cover.colour;
    const exact = passes === this.meshedWater ? 1 : 0;
    this.water.compose({ ...own, cover, thick: passes.thickness.colour, exact }, this.scene, this.image);
    this.drops.draw(sorted.water, { ...own, cover });
    for (const shape of sorted.glass) shape.drawFaces(this.glass, { ...values, cover, over: 1 });
    for (const shape of sorted.glass) shape.drawEdges(this.glass, own, true);
    this.stage("water shading");
  }
  /* Draws a frame into the canvas, whose size in pixels is set. */
  draw(frame, level = levels[0]) {
    const gl = this.gl, { width, height } = gl.canvas;
    if (this.stale || this.uploaded !== frame) this.upload(frame);
    this.stage("upload");
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    const sorted = this.sort(), shared = { cut: cutPlane(this.camera), ...this.vessel, ...this.liquids };
    this.drawShadows(sorted, shared, level);
    this.stage("shadows");
    const values = {
      ...shared, ...this.camera.matrices(width / height), ...this.shadows.values(level.shadow), soft: level.soft,
      height, window: [width, height], width: Math.max(1, 1.2 * height / 800), cover: this.maps.mako,
    };
    this.scene.begin(width, height);
    this.backdrop.drawBackground(values);
    this.drawScene(sorted, values);
    this.stage("scene");
    if (sorted.water.length) this.drawWater(sorted, values, level);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    gl.disable(gl.DEPTH_TEST);
    drawWindow(gl, this.finish, { scene: (sorted.water.length ? this.image : this.scene).colour, soft: level.soft });
    this.stage("finish");
  }
}
