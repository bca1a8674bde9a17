// The 3-D view: bodies, then their shading, then chains and lines, then the canvas.

// Machines that take longer than this for a picture [ms] draw coarsely while the view moves.
const SLOW = 45;

// Pixels drawn for each pixel of the screen along each axis, and samples of the gaps between bodies.
const PLAIN = { fineness: 1, samples: 0 };
const COARSE = { fineness: 0.5, samples: 0 };
const GOOD = { fineness: 1, samples: 12 };
const FINE = { fineness: 2, samples: 16 };

// Towards the lamp, to the right, up and towards the eye.
const LAMP = [-0.453, 0.655, 0.604];

class View {
  constructor(canvas, pack) {
    const options = { antialias: false, depth: false, powerPreference: "high-performance" };
    const gl = canvas.getContext("webgl2", options);
    if (!gl) throw new Error("this browser offers no WebGL 2");
    Object.assign(this, { canvas, gl, pack, targets: null, time: 0, waiting: false, pending: 0 });
    this.camera = new Camera(pack.frame.half);
    this.state = {
      bodies: "solid", walls: true, chains: false, threshold: 1.5, chosen: 0,
      cut: { on: false, whole: false, plane: [0, 0, 0, 1] },
    };
    this.bodies = new Bodies(gl, pack);
    this.overlay = new Overlay(gl, pack);
    this.shading = makeProgram(gl, "screen-vert", "shade-frag");
    this.presenting = makeProgram(gl, "screen-vert", "present-frag");
    this.empty = gl.createVertexArray();
    this.rows = Math.max(1, Math.ceil(pack.count / 256));
    this.colours = makeTexture(gl, gl.RGBA8, 256, this.rows);
    this.theme = { paper: [1, 1, 1], ink: [0, 0, 0], accent: [1, 0, 0] };
  }

  // One colour for each body: red, green, blue and 255.
  setColours(bytes) {
    const gl = this.gl;
    const padded = new Uint8Array(1024 * this.rows);
    padded.set(bytes);
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 256, this.rows, gl.RGBA, gl.UNSIGNED_BYTE, padded);
    this.refresh();
  }

  // Draws soon: coarsely if the machine is slow and the view is still moving, then finely at rest.
  refresh(moving = false) {
    clearTimeout(this.pending);
    this.atRest = false;
    this.next = this.pace(moving);
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw(this.next);
      const slow = this.time > SLOW;
      this.pending = setTimeout(() => {
        this.draw(slow ? GOOD : FINE);
        this.atRest = true;
      }, slow ? 350 : 120);
    });
  }

  // The first picture is a plain one, and tells how fast the machine is.
  pace(moving) {
    if (this.time === 0) return PLAIN;
    if (this.time <= SLOW) return GOOD;
    return moving ? COARSE : PLAIN;
  }

  // Width and height that the canvas should have, in its own pixels.
  size() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const { clientWidth, clientHeight } = this.canvas;
    return [clientWidth, clientHeight].map((x) => Math.max(1, Math.round(x * ratio)));
  }

  fits() {
    const [width, height] = this.size();
    return this.canvas.width === width && this.canvas.height === height;
  }

  draw({ fineness, samples }) {
    const { gl, canvas, camera, state } = this;
    const [width, height] = this.size();
    if (!this.fits()) Object.assign(canvas, { width, height });
    const began = performance.now();
    camera.setAspect(width / height);
    this.prepare(Math.round(width * fineness), Math.round(height * fineness));
    const [matrix, eye] = [camera.matrix(), camera.eye];
    gl.viewport(0, 0, this.targets.width, this.targets.height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.targets.scene);
    this.bodies.draw(matrix, eye, state);
    this.shade(fineness, samples);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.targets.overlay);
    this.overlay.draw(matrix, eye, this.lampInDrawing(), this.theme.ink, state);
    this.present(width, height);
    if (fineness === 1 && (samples === 0 || this.time > SLOW)) this.measure(began);
  }

  present(width, height) {
    const { gl, targets } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(this.presenting.program);
    gl.bindTexture(gl.TEXTURE_2D, targets.picture);
    gl.uniform1i(this.presenting.at.picture, 0);
    gl.uniform2f(this.presenting.at.screen, width, height);
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  // Waits for the picture, and keeps the time that it took [ms]; the first may be slow for other reasons.
  measure(began) {
    const gl = this.gl;
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    this.time = performance.now() - began;
    this.canvas.dataset.ready ??= Math.round(performance.now());
  }

  prepare(width, height) {
    if (this.targets && this.targets.width === width && this.targets.height === height) return;
    if (this.targets) this.targets.release();
    this.targets = new Targets(this.gl, width, height);
  }

  // The lamp stands above the eye, to the left.
  lampInDrawing() {
    const { right, up, toward } = this.camera.axes();
    return add(add(times(right, LAMP[0]), times(up, LAMP[1])), times(toward, LAMP[2]));
  }

  shade(fineness, samples) {
    const { gl, targets, state, theme, pack } = this;
    const { program, at } = this.shading;
    gl.bindFramebuffer(gl.FRAMEBUFFER, targets.shaded);
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(program);
    [["surface", targets.surface], ["number", targets.number], ["depth", targets.depth], ["colours", this.colours]].forEach(
      ([name, texture], k) => {
        gl.activeTexture(gl.TEXTURE0 + k);
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.uniform1i(at[name], k);
      },
    );
    gl.activeTexture(gl.TEXTURE0);
    const diameter = pack.diameter / pack.frame.unit;
    const pixels = diameter / this.camera.pixel(targets.height);
    const { right, up, toward } = this.camera.axes();
    gl.uniform2fv(at.tangents, this.camera.tangents);
    gl.uniform2fv(at.range, this.camera.range());
    gl.uniformMatrix3fv(at.axes, false, [...right, ...up, ...toward]);
    gl.uniform3fv(at.lamp, LAMP);
    gl.uniform3fv(at.paper, theme.paper);
    gl.uniform3fv(at.accent, theme.accent);
    gl.uniform1f(at.solidity, state.bodies === "solid" ? 1 : 0.16);
    gl.uniform1f(at.crease, clamp((pixels / fineness - 14) / 30, 0, 1));
    gl.uniform1f(at.gap, 0.5 * diameter);
    gl.uniform1f(at.gapPixels, clamp(0.42 * pixels, 2, 160));
    gl.uniform1i(at.samples, samples);
    gl.uniform1ui(at.chosen, state.chosen);
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.enable(gl.DEPTH_TEST);
  }

  // The body at a place of the canvas [CSS pixels], as listed; −1 for none.
  pick(x, y) {
    if (!this.targets) return -1;
    const { gl, canvas, targets } = this;
    const column = Math.floor((x / canvas.clientWidth) * targets.width);
    const row = Math.floor((1 - y / canvas.clientHeight) * targets.height);
    const bytes = new Uint8Array(4);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, targets.scene);
    gl.readBuffer(gl.COLOR_ATTACHMENT1);
    gl.readPixels(column, row, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    gl.readBuffer(gl.COLOR_ATTACHMENT0);
    return (bytes[0] | (bytes[1] << 8) | (bytes[2] << 16)) - 1;
  }
}
