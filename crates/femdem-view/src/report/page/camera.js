// The eye: it goes round a point, always upright.

class Camera {
  constructor(half) {
    this.half = half;
    this.aspect = 1;
    this.look("iso");
  }

  // A standard view; the front is at negative y.
  look(name) {
    const angles = { front: [0, 0], side: [90, 0], top: [0, 90], iso: [24, 16] };
    this.standard = name;
    const [azimuth, elevation] = angles[name];
    this.azimuth = (azimuth * Math.PI) / 180;
    this.elevation = (elevation * Math.PI) / 180;
    this.target = [0, 0, 0];
    this.distance = this.fit();
    for (let round = 0; round < 3; round++) this.centre();
  }

  // Fits a standard view again when the shape of the canvas changes.
  setAspect(aspect) {
    if (aspect === this.aspect) return;
    this.aspect = aspect;
    if (this.standard) this.look(this.standard);
  }

  // The tangents of half the angles of view: the smaller one is fixed.
  get tangents() {
    const small = 0.27;
    return this.aspect > 1 ? [small * this.aspect, small] : [small, small / this.aspect];
  }

  corners() {
    return [0, 1, 2, 3, 4, 5, 6, 7].map((i) => this.half.map((h, k) => ((i >> k) & 1 ? h : -h)));
  }

  // The distance from which the pack's box just fits.
  fit() {
    const { right, up, toward } = this.axes();
    const [across, upward] = this.tangents;
    const needs = this.corners().map((corner) => {
      const p = subtract(corner, this.target);
      return Math.max(Math.abs(dot(p, right)) / across, Math.abs(dot(p, up)) / upward) + dot(p, toward);
    });
    return 1.05 * Math.max(...needs);
  }

  // Moves the target so that the box is seen in the middle.
  centre() {
    const { right, up, toward } = this.axes();
    for (const axis of [right, up]) {
      const seen = this.corners().map((corner) => {
        const p = subtract(corner, this.target);
        return dot(p, axis) / (this.distance - dot(p, toward));
      });
      const middle = (Math.min(...seen) + Math.max(...seen)) / 2;
      this.target = add(this.target, times(axis, middle * this.distance));
    }
    this.distance = this.fit();
  }

  axes() {
    const [sa, ca] = [Math.sin(this.azimuth), Math.cos(this.azimuth)];
    const [se, ce] = [Math.sin(this.elevation), Math.cos(this.elevation)];
    return { right: [ca, sa, 0], up: [-sa * se, ca * se, ce], toward: [sa * ce, -ca * ce, se] };
  }

  get eye() {
    return add(this.target, times(this.axes().toward, this.distance));
  }

  // Depths between which all things lie.
  range() {
    const reach = Math.hypot(...this.half) * 1.2 + Math.hypot(...this.target);
    return [Math.max(this.distance - reach, 0.01 * this.distance, 1e-3), this.distance + reach];
  }

  // From the drawing to the screen.
  matrix() {
    const { right, up, toward } = this.axes();
    return product(perspective(...this.tangents, ...this.range()), lookFrom(this.eye, right, up, toward));
  }

  // Size of a pixel at the target.
  pixel(height) {
    return (2 * this.tangents[1] * this.distance) / height;
  }

  rotate(dx, dy) {
    this.standard = null;
    this.azimuth -= dx;
    this.elevation = clamp(this.elevation + dy, -Math.PI / 2, Math.PI / 2);
  }

  pan(dx, dy) {
    this.standard = null;
    const { right, up } = this.axes();
    const moved = add(this.target, add(times(right, -dx), times(up, dy)));
    this.target = moved.map((x) => clamp(x, -1.5, 1.5));
  }

  zoom(factor) {
    this.standard = null;
    this.distance = clamp(this.distance * factor, 0.02, 30);
  }
}
