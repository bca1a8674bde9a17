// The numbers of the page: one base64 block of typed arrays, and an index that names them.

function readPack() {
  const index = JSON.parse(document.getElementById("index").textContent);
  const bytes = fromBase64(document.getElementById("numbers").textContent.trim());
  const kinds = { Float32Array, Uint32Array, Uint16Array, Int16Array, Uint8Array };
  const arrays = {};
  for (const [name, [kind, offset, length]] of Object.entries(index.arrays)) {
    arrays[name] = new kinds[kind](bytes.buffer, offset, length);
  }
  const count = arrays.body.length;
  const listedAs = new Uint32Array(count);
  arrays.body.forEach((body, listed) => { listedAs[body] = listed; });
  return { ...index, arrays, count, listedAs, frame: frameOf(index, arrays) };
}

function fromBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

// The drawing has its origin in the middle of the pack, and half the pack's diagonal for its unit.
function frameOf(index, arrays) {
  const low = [...index.origin];
  const high = low.map((x, k) => x + index.size[k]);
  for (const name of ["lines", "floor"]) {
    arrays[name].forEach((x, i) => {
      low[i % 3] = Math.min(low[i % 3], x);
      high[i % 3] = Math.max(high[i % 3], x);
    });
  }
  // Without a container, bodies reach beyond their centres.
  const margin = arrays.lines.length > 0 ? 0 : index.diameter / 2;
  const centre = low.map((x, k) => (x + high[k]) / 2);
  const unit = Math.hypot(...low.map((x, k) => (high[k] - x) / 2 + margin));
  const toDrawing = (x, k) => (x - centre[k]) / unit;
  return {
    centre,
    unit,
    toDrawing,
    origin: index.origin.map(toDrawing),
    size: index.size.map((x) => x / unit),
    half: low.map((x, k) => ((high[k] - x) / 2 + margin) / unit),
  };
}

// Where a 16-bit place lies in the drawing.
function placeInDrawing(pack, places, i) {
  const { origin, size } = pack.frame;
  return [0, 1, 2].map((k) => origin[k] + (size[k] * places[3 * i + k]) / 65535);
}
