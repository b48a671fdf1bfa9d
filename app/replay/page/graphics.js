/* WebGL 2: programs, vertex arrays, textures and render targets. */

function compileShader(gl, type, text) {
  const shader = gl.createShader(type);
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  return shader;
}

/* A program with the list of its uniforms. The GLSL text `common` comes before both shaders. */
function compile(gl, common, vertex, fragment) {
  const program = gl.createProgram();
  const head = "#version 300 es\nprecision highp float;\nprecision highp sampler2DShadow;\n";
  gl.attachShader(program, compileShader(gl, gl.VERTEX_SHADER, head + common + vertex));
  gl.attachShader(program, compileShader(gl, gl.FRAGMENT_SHADER, head + common + fragment));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS))
    throw new Error([gl.getProgramInfoLog(program), ...gl.getAttachedShaders(program)
      .map((shader) => gl.getShaderInfoLog(shader))].join("\n"));
  const uniforms = [];
  for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); k++) {
    const { name, type } = gl.getActiveUniform(program, k);
    const location = gl.getUniformLocation(program, name);
    uniforms.push({ name: name.replace("[0]", ""), type, location }); /* an array is named by its first entry */
  }
  return { program, uniforms };
}

/* Makes a program current and sets each of its uniforms from `values` by name; a sampler's value is a texture. */
function use(gl, { program, uniforms }, values) {
  let unit = 0;
  gl.useProgram(program);
  for (const { name, type, location } of uniforms) {
    const value = values[name];
    if (value === undefined) throw new Error(`no value for the uniform ${name}`);
    if (type === gl.SAMPLER_2D || type === gl.SAMPLER_2D_SHADOW) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, value);
      gl.uniform1i(location, unit++);
    } else if (type === gl.FLOAT) gl.uniform1f(location, value);
    else if (type === gl.FLOAT_VEC2) gl.uniform2fv(location, value);
    else if (type === gl.FLOAT_VEC3) gl.uniform3fv(location, value);
    else if (type === gl.FLOAT_VEC4) gl.uniform4fv(location, value);
    else gl.uniformMatrix4fv(location, false, value);
  }
}

/* Adds an attribute with a buffer of its own to a vertex array; integers become 0...1. Returns the buffer. */
function addAttribute(gl, array, location, parts, type) {
  const buffer = gl.createBuffer();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.enableVertexAttribArray(location);
  gl.vertexAttribPointer(location, parts, type, type !== gl.FLOAT, 0, 0);
  return buffer;
}

function fillBuffer(gl, buffer, values) {
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
}

function addIndices(gl, array, index) {
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
}

function makeTexture(gl, filter) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, side, filter);
  for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
  return texture;
}

/* Layout of the pixels of a target: [internal format, format, type]. */
const pixelLayouts = (gl) => ({
  colour: [gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE],
  sums: [gl.RGBA16F, gl.RGBA, gl.HALF_FLOAT],
  number: [gl.R32F, gl.RED, gl.FLOAT],
  depth: [gl.DEPTH_COMPONENT32F, gl.DEPTH_COMPONENT, gl.FLOAT],
});

/* A framebuffer with a texture of colours ("colour", "sums", "number" or none) and perhaps one of depths. */
class Target {
  constructor(gl, colour, depth, depthFilter = gl.NEAREST) {
    Object.assign(this, { gl, kind: colour, width: 0, height: 0 });
    this.framebuffer = gl.createFramebuffer();
    this.colour = colour && makeTexture(gl, colour === "number" ? gl.NEAREST : gl.LINEAR);
    this.depth = depth && makeTexture(gl, depthFilter);
  }
  attach(texture, kind, place) {
    const gl = this.gl, [inside, format, type] = pixelLayouts(gl)[kind];
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, inside, this.width, this.height, 0, format, type, null);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, place, gl.TEXTURE_2D, texture, 0);
  }
  /* Makes the target current with a size in pixels and clears it. */
  begin(width, height, clear = [0, 0, 0, 0]) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    if (width !== this.width || height !== this.height) {
      Object.assign(this, { width, height });
      if (this.colour) this.attach(this.colour, this.kind, gl.COLOR_ATTACHMENT0);
      if (this.depth) this.attach(this.depth, "depth", gl.DEPTH_ATTACHMENT);
    }
    gl.viewport(0, 0, width, height);
    gl.clearColor(...clear);
    gl.depthMask(true);
    gl.clear((this.colour ? gl.COLOR_BUFFER_BIT : 0) | (this.depth ? gl.DEPTH_BUFFER_BIT : 0));
    if (this.depth) gl.enable(gl.DEPTH_TEST);
    else gl.disable(gl.DEPTH_TEST);
  }
}

/* One triangle that covers the window. Fragment shaders read `uv`, 0...1. */
const windowVertex = `
out vec2 uv;
void main() {
  uv = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
  gl_Position = vec4(2.0 * uv - 1.0, 0, 1);
}`;

function drawWindow(gl, program, values) {
  use(gl, program, values);
  gl.bindVertexArray(null);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}
