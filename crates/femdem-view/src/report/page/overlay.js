// What is drawn over the bodies: the container's edges and the force chains.

const TUBE_SIDES = 10;

class Overlay {
  constructor(gl, pack) {
    this.gl = gl;
    this.pack = pack;
    this.lines = makeProgram(gl, "plain-vert", "plain-frag");
    const ends = pack.arrays.lines.map((x, i) => pack.frame.toDrawing(x, i % 3));
    this.lineEnds = ends.length / 3;
    this.lineArray = gl.createVertexArray();
    gl.bindVertexArray(this.lineArray);
    attribute(gl, 0, fill(gl, gl.ARRAY_BUFFER, ends), 3, gl.FLOAT, false);
    this.prepareTubes();
  }

  prepareTubes() {
    const gl = this.gl;
    this.tubeArray = gl.createVertexArray();
    gl.bindVertexArray(this.tubeArray);
    const strip = Array.from({ length: TUBE_SIDES + 1 }, (_, k) => [k / TUBE_SIDES, 0, k / TUBE_SIDES, 1]);
    attribute(gl, 0, fill(gl, gl.ARRAY_BUFFER, new Float32Array(strip.flat())), 2, gl.FLOAT, false);
    this.tubeBuffer = gl.createBuffer();
    [[1, 3, 0], [2, 3, 12], [3, 2, 24]].forEach(([location, size, offset]) => {
      attribute(gl, location, this.tubeBuffer, size, gl.FLOAT, false, 1, 32, offset);
    });
    this.tubeCount = 0;
    this.threshold = null;
  }

  // Tubes for the contacts whose strength is above the threshold. Their radius grows with the force.
  setThreshold(threshold) {
    if (threshold === this.threshold) return;
    this.threshold = threshold;
    const { arrays, frame, count, diameter } = this.pack;
    const strength = arrays["contact-strength"];
    const rows = [];
    for (let i = 0; i < strength.length; i++) {
      if (!(strength[i] > threshold)) continue;
      const second = arrays["contact-second"][i];
      const from = placeInDrawing(this.pack, arrays.place, arrays["contact-first"][i]);
      const isBody = second < count;
      const to = isBody
        ? placeInDrawing(this.pack, arrays.place, second)
        : placeInDrawing(this.pack, arrays["contact-point"], i);
      const shown = clamp(strength[i] / 4, 0, 1);
      const radius = ((0.015 + 0.125 * shown) * diameter) / frame.unit;
      rows.push(...from, ...to, radius, Math.sqrt(shown));
    }
    this.tubeCount = rows.length / 8;
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.tubeBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(rows), gl.DYNAMIC_DRAW);
  }

  draw(camera, eye, lamp, ink, state) {
    const gl = this.gl;
    if (state.walls) this.drawLines(camera, ink);
    if (!state.chains) return;
    // See-through bodies hide no tube.
    if (state.bodies !== "solid") gl.clearBufferfv(gl.DEPTH, 0, [1]);
    this.setThreshold(state.threshold);
    // Made when it is first needed, so that the page opens sooner.
    this.tubes ??= makeProgram(gl, "tubes-vert", "tubes-frag");
    const { program, at } = this.tubes;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.camera, false, camera);
    gl.uniform3fv(at.eye, eye);
    gl.uniform3fv(at.lamp, lamp);
    gl.uniform4fv(at.cut, state.cut.plane);
    gl.bindVertexArray(this.tubeArray);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 2 * TUBE_SIDES + 2, this.tubeCount);
  }

  // Hidden parts are faint.
  drawLines(camera, ink) {
    const gl = this.gl;
    gl.useProgram(this.lines.program);
    gl.uniformMatrix4fv(this.lines.at.camera, false, camera);
    gl.bindVertexArray(this.lineArray);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    for (const [test, alpha] of [[gl.GREATER, 0.12], [gl.LEQUAL, 0.75]]) {
      gl.depthFunc(test);
      gl.uniform4fv(this.lines.at.ink, [...ink, alpha]);
      gl.drawArrays(gl.LINES, 0, this.lineEnds);
    }
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }
}
