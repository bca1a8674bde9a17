// The bodies and the floor: what is where on the screen. Each shape is drawn once for all its bodies.

class Bodies {
  constructor(gl, pack) {
    this.gl = gl;
    this.pack = pack;
    this.plain = makeProgram(gl, "bodies-vert", "bodies-frag");
    this.floor = makeProgram(gl, "plain-vert", "floor-frag");
    const places = fill(gl, gl.ARRAY_BUFFER, pack.arrays.place);
    const turns = fill(gl, gl.ARRAY_BUFFER, pack.arrays.turn);
    let first = 0;
    this.shapes = pack.shapes.map((shape, k) => {
      const made = this.prepare(shape, k, first, places, turns);
      first += shape.count;
      return made;
    });
    this.prepareFloor();
  }

  // Made when it is first needed, so that the page opens sooner.
  opened() {
    this.cutting ??= makeProgram(this.gl, "bodies-vert", "bodies-frag", ["CUT"]);
    return this.cutting;
  }

  prepare(shape, k, first, places, turns) {
    const { gl, pack } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const points = pack.arrays[`points-${k}`].map((x) => x / pack.frame.unit);
    attribute(gl, 0, fill(gl, gl.ARRAY_BUFFER, points), 3, gl.FLOAT, false);
    attribute(gl, 1, fill(gl, gl.ARRAY_BUFFER, pack.arrays[`normals-${k}`]), 3, gl.FLOAT, false);
    attribute(gl, 2, places, 3, gl.UNSIGNED_SHORT, true, 1, 6, 6 * first);
    attribute(gl, 3, turns, 4, gl.SHORT, true, 1, 8, 8 * first);
    fill(gl, gl.ELEMENT_ARRAY_BUFFER, pack.arrays[`corners-${k}`]);
    const corners = pack.arrays[`corners-${k}`].length;
    return { array, first, corners, count: shape.count, radius: shape.radius / pack.frame.unit };
  }

  prepareFloor() {
    const { gl, pack } = this;
    const points = pack.arrays.floor.map((x, i) => pack.frame.toDrawing(x, i % 3));
    this.floorPoints = points.length / 3;
    this.floorHeight = points[2];
    this.floorArray = gl.createVertexArray();
    gl.bindVertexArray(this.floorArray);
    attribute(gl, 0, fill(gl, gl.ARRAY_BUFFER, points), 3, gl.FLOAT, false);
  }

  draw(camera, eye, state) {
    const { gl, pack } = this;
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.COLOR, 1, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    const open = state.cut.on && !state.cut.whole;
    const { program, at } = open ? this.opened() : this.plain;
    gl.useProgram(program);
    if (open) gl.disable(gl.CULL_FACE);
    else gl.enable(gl.CULL_FACE);
    gl.uniformMatrix4fv(at.camera, false, camera);
    gl.uniform3fv(at.origin, pack.frame.origin);
    gl.uniform3fv(at.size, pack.frame.size);
    gl.uniform4fv(at.cut, state.cut.plane);
    for (const shape of state.bodies === "hidden" ? [] : this.shapes) {
      if (shape.count === 0) continue;
      gl.uniform1f(at.reach, open ? shape.radius : 0);
      gl.uniform1ui(at.first, shape.first);
      gl.bindVertexArray(shape.array);
      gl.drawElementsInstanced(gl.TRIANGLES, shape.corners, gl.UNSIGNED_INT, 0, shape.count);
    }
    gl.disable(gl.CULL_FACE);
    if (state.walls && eye[2] > this.floorHeight && this.floorPoints > 2) this.drawFloor(camera);
  }

  drawFloor(camera) {
    const gl = this.gl;
    gl.useProgram(this.floor.program);
    gl.uniformMatrix4fv(this.floor.at.camera, false, camera);
    gl.bindVertexArray(this.floorArray);
    gl.drawArrays(gl.TRIANGLE_FAN, 0, this.floorPoints);
  }
}
