// Mouse, touch and keys on the canvas.

class Gestures {
  // `click` is called with the place of a press that did not move.
  constructor(view, click) {
    Object.assign(this, { view, click, fingers: new Map(), travel: 0 });
    const canvas = view.canvas;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("pointercancel", (event) => this.fingers.delete(event.pointerId));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  down(event) {
    if (this.fingers.size === 0) this.travel = 0;
    this.view.canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
  }

  move(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const [dx, dy] = subtract(now, before);
    this.travel += Math.abs(dx) + Math.abs(dy);
    const { camera, canvas } = this.view;
    const pixel = camera.pixel(canvas.clientHeight);
    const others = [...this.fingers].filter(([id]) => id !== event.pointerId);
    if (others.length > 0) {
      const other = others[0][1];
      const spread = (place) => Math.hypot(...subtract(place, other)) || 1;
      camera.zoom(spread(before) / spread(now));
      camera.pan((dx * pixel) / 2, (dy * pixel) / 2);
    } else if (event.buttons & 6 || event.shiftKey || event.ctrlKey) {
      camera.pan(dx * pixel, dy * pixel);
    } else {
      camera.rotate(dx * 0.007, dy * 0.007);
    }
    this.fingers.set(event.pointerId, now);
    this.view.refresh(true);
  }

  up(event) {
    const alone = this.fingers.size === 1;
    const known = this.fingers.delete(event.pointerId);
    if (known && alone && this.travel < 5 && event.button === 0) {
      const box = this.view.canvas.getBoundingClientRect();
      this.click(event.clientX - box.left, event.clientY - box.top);
    }
  }

  wheel(event) {
    event.preventDefault();
    const { camera, canvas } = this.view;
    const box = canvas.getBoundingClientRect();
    const factor = Math.exp(clamp(event.deltaY, -150, 150) * 0.0016);
    // What is under the pointer stays there.
    const pixel = camera.pixel(canvas.clientHeight);
    const dx = event.clientX - box.left - box.width / 2;
    const dy = event.clientY - box.top - box.height / 2;
    camera.zoom(factor);
    camera.pan(dx * pixel * (factor - 1), dy * pixel * (factor - 1));
    this.view.refresh(true);
  }

  key(event) {
    const { camera } = this.view;
    const step = 0.12;
    const shift = event.shiftKey ? 0.1 * camera.distance : 0;
    const moves = {
      ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
    };
    if (moves[event.key]) {
      const [dx, dy] = moves[event.key];
      if (shift) camera.pan(-dx * 0.5 * shift, -dy * 0.5 * shift);
      else camera.rotate(-dx * step, -dy * step);
    } else if (event.key === "+" || event.key === "=") {
      camera.zoom(0.88);
    } else if (event.key === "-") {
      camera.zoom(1 / 0.88);
    } else {
      return;
    }
    event.preventDefault();
    this.view.refresh(true);
  }
}
