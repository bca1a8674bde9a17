// The numbers of the body that was clicked.

const CLASSES = ["point", "edge on face", "face on face"];

class Details {
  // `choose` is called with a body's place in the list when another body is asked for.
  constructor(pack, choose) {
    Object.assign(this, { pack, choose, box: document.getElementById("details") });
    this.number = document.getElementById("number");
    this.number.max = pack.count - 1;
    this.number.addEventListener("change", () => {
      const body = Math.round(Number(this.number.value));
      const known = this.number.value !== "" && body >= 0 && body < pack.count;
      choose(known ? pack.listedAs[body] : -1);
    });
  }

  show(listed) {
    this.box.replaceChildren();
    const hint = document.getElementById("hint");
    hint.hidden = listed >= 0;
    if (listed < 0) {
      this.number.value = "";
      return;
    }
    const { arrays, fields } = this.pack;
    this.number.value = arrays.body[listed];
    const rows = [["shape", this.shapeOf(listed)], ["centre / m", this.centre(listed)]];
    for (const field of fields) {
      rows.push([field.title, short(arrays[`field-${field.key}`][listed])]);
    }
    this.box.append(table(rows, ["quantity", "value"], "numbers"));
    this.showContacts(listed);
  }

  shapeOf(listed) {
    let first = 0;
    for (const shape of this.pack.shapes) {
      first += shape.count;
      if (listed < first) return shape.name;
    }
    return "";
  }

  centre(listed) {
    const { frame, arrays } = this.pack;
    const place = placeInDrawing(this.pack, arrays.place, listed);
    return place.map((x, k) => (x * frame.unit + frame.centre[k]).toFixed(4)).join(", ");
  }

  showContacts(listed) {
    const { arrays, count, walls } = this.pack;
    const rows = [];
    arrays["contact-first"].forEach((first, i) => {
      const second = arrays["contact-second"][i];
      if (first !== listed && second !== listed) return;
      const other = first === listed ? second : first;
      const partner = other < count ? this.link(other) : walls[0xffffffff - other];
      const forces = ["contact-force", "contact-friction"].map((name) => short(arrays[name][i]));
      rows.push({ force: arrays["contact-force"][i], cells: [partner, ...forces, CLASSES[arrays["contact-class"][i]]] });
    });
    rows.sort((a, b) => b.force - a.force);
    if (rows.length > 0) {
      const head = ["contact with", "normal / N", "friction / N", "kind"];
      this.box.append(table(rows.map((row) => row.cells), head, "contacts"));
    }
  }

  link(other) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "link";
    button.textContent = `body ${this.pack.arrays.body[other]}`;
    button.addEventListener("click", () => this.choose(other));
    return button;
  }
}

function table(rows, head, name) {
  const made = document.createElement("table");
  made.className = name;
  const line = (cells, kind) => {
    const row = document.createElement("tr");
    for (const cell of cells) {
      const item = document.createElement(kind);
      item.append(cell);
      row.append(item);
    }
    return row;
  };
  const top = document.createElement("thead");
  top.append(line(head, "th"));
  const body = document.createElement("tbody");
  body.append(...rows.map((row) => line(row, "td")));
  made.append(top, body);
  return made;
}
