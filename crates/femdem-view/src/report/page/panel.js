// The controls beside the view, and the colour scale below it.

class Panel {
  constructor(view) {
    this.view = view;
    this.pack = view.pack;
    this.details = new Details(view.pack, (listed) => this.choose(listed));
    this.colour = document.getElementById("colour");
    for (const field of this.pack.fields) this.colour.add(new Option(field.title, field.key));
    this.on("colour", "change", () => this.recolour());
    this.on("bodies", "change", (input) => this.set({ bodies: input.value }));
    this.on("walls", "change", (input) => this.set({ walls: input.checked }));
    this.on("chains", "change", (input) => this.setChains(input.checked));
    this.on("threshold", "input", (input) => this.setThreshold(Number(input.value)));
    for (const name of ["cut-axis", "cut-place", "cut-whole"]) this.on(name, "input", () => this.cut());
    for (const button of document.querySelectorAll("[data-look]")) {
      button.addEventListener("click", () => {
        view.camera.look(button.dataset.look);
        view.refresh();
      });
    }
    if (!this.pack.arrays["contact-force"].length) document.getElementById("chain-controls").hidden = true;
    this.readTheme();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.readTheme();
      view.refresh();
    });
    this.setThreshold(1.5);
    this.recolour();
  }

  on(id, event, action) {
    const input = document.getElementById(id);
    input.addEventListener(event, () => action(input));
  }

  set(change) {
    Object.assign(this.view.state, change);
    this.view.refresh();
  }

  // Chains within solid bodies could not be seen.
  setChains(chains) {
    const bodies = document.getElementById("bodies");
    if (chains && bodies.value === "solid") bodies.value = "faint";
    if (!chains && bodies.value === "faint") bodies.value = "solid";
    document.getElementById("threshold").disabled = !chains;
    this.set({ chains, bodies: bodies.value });
  }

  setThreshold(threshold) {
    document.getElementById("threshold-value").textContent = threshold.toFixed(2);
    this.set({ threshold });
  }

  choose(listed) {
    this.details.show(listed);
    this.set({ chosen: listed + 1 });
  }

  recolour() {
    const field = this.pack.fields.find(({ key }) => key === this.colour.value);
    this.view.setColours(coloursOf(this.pack, field));
    document.getElementById("scale-title").textContent = field.title;
    document.getElementById("scale-note").textContent = field.note;
    const ticks = ticksOf(field).map((tick) => {
      const mark = document.createElement("span");
      mark.textContent = short(tick);
      mark.style.left = `${100 * placeOnScale(field, tick)}%`;
      return mark;
    });
    document.getElementById("scale-ticks").replaceChildren(...ticks);
  }

  // A plane across an axis of the container, or across the line of sight as it is now.
  cut() {
    const axis = document.getElementById("cut-axis").value;
    const place = document.getElementById("cut-place");
    const whole = document.getElementById("cut-whole");
    place.disabled = whole.disabled = axis === "none";
    if (axis === "none") {
      this.sight = null;
      this.set({ cut: { on: false, whole: false, plane: [0, 0, 0, 1] } });
      return;
    }
    // The side of the front, of the right or of the top is cut away.
    const normals = { x: [1, 0, 0], y: [0, -1, 0], z: [0, 0, 1] };
    if (axis !== "sight") this.sight = null;
    else if (!this.sight) this.sight = this.view.camera.axes().toward;
    const normal = this.sight || normals[axis];
    const reach = dot(normal.map(Math.abs), this.view.camera.half);
    const plane = [...normal, reach * (2 * Number(place.value) - 1)];
    this.set({ cut: { on: true, whole: whole.checked, plane } });
  }

  readTheme() {
    const style = getComputedStyle(document.documentElement);
    const read = (name) => {
      const code = parseInt(style.getPropertyValue(name).trim().slice(1), 16);
      return [code >> 16, (code >> 8) & 255, code & 255].map((c) => c / 255);
    };
    this.view.theme = { paper: read("--stage"), ink: read("--ink"), accent: read("--accent") };
  }
}
