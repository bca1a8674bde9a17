// Small helpers around WebGL2.

function shaderText(name) {
  return document.getElementById(`shader-${name}`).textContent.trim();
}

// A program with its uniforms by name; `defines` are set for its fragment shader.
function makeProgram(gl, vertex, fragment, defines = []) {
  const program = gl.createProgram();
  const sources = [[gl.VERTEX_SHADER, shaderText(vertex)], [gl.FRAGMENT_SHADER, shaderText(fragment)]];
  for (const [kind, text] of sources) {
    const shader = gl.createShader(kind);
    const lines = defines.map((name) => `#define ${name}\n`).join("");
    gl.shaderSource(shader, `#version 300 es\nprecision highp float;\nprecision highp int;\n${lines}${text}`);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
      throw new Error(`${vertex}, ${fragment}: ${gl.getShaderInfoLog(shader)}`);
    }
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`${vertex}, ${fragment}: ${gl.getProgramInfoLog(program)}`);
  }
  const at = {};
  const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < count; i++) {
    const { name } = gl.getActiveUniform(program, i);
    at[name] = gl.getUniformLocation(program, name);
  }
  return { program, at };
}

// A buffer as an attribute of the vertex array that is bound; `every` is 1 for one value an instance.
function attribute(gl, location, buffer, size, kind, normalised, every = 0, stride = 0, offset = 0) {
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.enableVertexAttribArray(location);
  gl.vertexAttribPointer(location, size, kind, normalised, stride, offset);
  gl.vertexAttribDivisor(location, every);
}

function fill(gl, target, data, usage = gl.STATIC_DRAW) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(target, buffer);
  gl.bufferData(target, data, usage);
  return buffer;
}

function makeTexture(gl, format, width, height, filter = gl.NEAREST) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, name, filter);
  }
  return texture;
}

// What a frame is drawn into: what is where (surface, number, depth), and the picture of it.
class Targets {
  constructor(gl, width, height) {
    Object.assign(this, { gl, width, height });
    this.surface = makeTexture(gl, gl.RGBA8, width, height);
    this.number = makeTexture(gl, gl.RGBA8, width, height);
    this.depth = makeTexture(gl, gl.DEPTH_COMPONENT24, width, height);
    this.picture = makeTexture(gl, gl.RGBA8, width, height, gl.LINEAR);
    this.scene = this.framebuffer([this.surface, this.number], this.depth);
    this.shaded = this.framebuffer([this.picture], null);
    this.overlay = this.framebuffer([this.picture], this.depth);
  }

  framebuffer(colours, depth) {
    const gl = this.gl;
    const framebuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    const places = colours.map((texture, k) => {
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + k, gl.TEXTURE_2D, texture, 0);
      return gl.COLOR_ATTACHMENT0 + k;
    });
    if (depth) gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth, 0);
    gl.drawBuffers(places);
    return framebuffer;
  }

  release() {
    for (const name of ["surface", "number", "depth", "picture"]) this.gl.deleteTexture(this[name]);
    for (const name of ["scene", "shaded", "overlay"]) this.gl.deleteFramebuffer(this[name]);
  }
}
