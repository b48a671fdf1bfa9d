/* Fluids as triangle meshes of their surfaces, which `projdyn render` hands over frame by frame (`projdyn mesh` writes
 * the same): the counterpart of the passes of water.js before compose, without their errors.
 *   cover     normal and depth of the nearest face at each pixel
 *   thickness sum of the depths of faces that end the fluid, less those of faces that begin it. A face behind
 *             something opaque does not count; .a is then 1, and the fluid ends there */
const waterMeshHead = `
in vec3 n, p;
uniform float distance, radius;
uniform vec2 window;
uniform sampler2D sceneDepth;
/* Whether the face is behind something opaque, or closer before it than meshes that touch can be told apart. */
bool hidden() { return p.z - 0.3 * radius < eyeDepth(texture(sceneDepth, gl_FragCoord.xy / window).r); }
`;
const waterMeshText = {
  vertex: `
layout(location = 0) in vec3 x;
layout(location = 1) in vec3 normal; /* 0 at obstacles, where edges are sharp */
out vec3 n, p; /* p: in eye space */
void main() {
  vec4 at = view * vec4(x, 1);
  n = mat3(view) * normal;
  p = at.xyz;
  gl_Position = projection * at;
}`,
  cover: `${waterMeshHead}
uniform float extent;
out vec4 result;
void main() {
  if (hidden()) discard;
  vec3 plane = normalize(cross(dFdx(p), dFdy(p))); /* normal of the triangle */
  result = vec4(normalize(n + (1.0 - length(n)) * plane).xy, (p.z + distance) / extent, 1);
}`,
  thickness: `${waterMeshHead}
uniform float liquid;
out vec4 result;
void main() {
  if (hidden()) discard;
  float begins = gl_FrontFacing ? 1.0 : 0.0;
  result = vec4((p.z + distance) * (2.0 * begins - 1.0), begins * liquid, begins, 2.0 * begins - 1.0);
}`,
};

/* The surface of one fluid on the graphics card. */
class WaterMesh {
  constructor(gl) {
    Object.assign(this, { gl, count: 0, array: gl.createVertexArray() });
    [this.x, this.normal] = [0, 1].map((k) => addAttribute(gl, this.array, k, 3, gl.FLOAT));
    this.index = gl.createBuffer();
  }
  upload(x, normal, triangle) {
    const gl = this.gl;
    fillBuffer(gl, this.x, x);
    fillBuffer(gl, this.normal, normal);
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.index);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangle, gl.DYNAMIC_DRAW);
    this.count = triangle.length;
  }
  draw(program, values) {
    use(this.gl, program, values);
    this.gl.bindVertexArray(this.array);
    this.gl.drawElements(this.gl.TRIANGLES, this.count, this.gl.UNSIGNED_INT, 0);
  }
}

/* The two passes. */
class MeshedWater {
  constructor(gl) {
    this.gl = gl;
    this.programs = {
      cover: compile(gl, commonText, waterMeshText.vertex, waterMeshText.cover),
      thickness: compile(gl, commonText, waterMeshText.vertex, waterMeshText.thickness),
    };
    this.cover = new Target(gl, "sums", true);
    this.thickness = new Target(gl, "sums", false);
  }
  /* bodies: Points with .mesh */
  prepare(bodies, values) {
    const gl = this.gl, [width, height] = values.window;
    this.cover.begin(width, height);
    for (const body of bodies) body.mesh.draw(this.programs.cover, values);
    this.thickness.begin(width, height);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    for (const body of bodies) body.mesh.draw(this.programs.thickness, { ...values, liquid: body.liquid });
    gl.disable(gl.BLEND);
  }
}

/* Whether the view shows fluids in a way that has a use for meshes. */
const drawsMeshes = () => settings.look === "surface" && settings.fluid === "plain" && !settings.cut;

/* For `projdyn render`: takes the mesh of a body, arrays in base64. */
function setSurface(body, ...texts) {
  const buffers = texts.map((text) => Uint8Array.from(atob(text), (digit) => digit.charCodeAt(0)).buffer);
  const shape = renderer.parts[body];
  shape.mesh ||= new WaterMesh(renderer.gl);
  shape.mesh.upload(new Float32Array(buffers[0]), new Float32Array(buffers[1]), new Uint32Array(buffers[2]));
  return "";
}
