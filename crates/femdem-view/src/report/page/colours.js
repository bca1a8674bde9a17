// Colours of bodies: viridis (S. van der Walt and N. Smith, 2015; CC0) over the range of a field.

const VIRIDIS = [
  0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70, 0x7ad151, 0xbddf26, 0xfde725,
].map((code) => [code >> 16, (code >> 8) & 255, code & 255]);
const UNKNOWN = [150, 150, 150];

function viridis(value) {
  if (Number.isNaN(value)) return UNKNOWN;
  const at = clamp(value, 0, 1) * 10;
  const low = Math.min(Math.floor(at), 9);
  return VIRIDIS[low].map((c, k) => Math.round(c + (VIRIDIS[low + 1][k] - c) * (at - low)));
}

// Place of a value on the scale of a field, 0 to 1.
function placeOnScale(field, value) {
  const [low, high] = field.range;
  if (field.spacing === "log") return Math.log(Math.max(value, low) / low) / Math.log(high / low);
  return (value - low) / (high - low);
}

function coloursOf(pack, field) {
  const values = pack.arrays[`field-${field.key}`];
  const bytes = new Uint8Array(4 * pack.count);
  values.forEach((value, i) => {
    bytes.set(viridis(placeOnScale(field, value)), 4 * i);
    bytes[4 * i + 3] = 255;
  });
  return bytes;
}

// Round numbers within the range of a field, about five.
function ticksOf(field) {
  const [low, high] = field.range;
  if (field.spacing === "log") {
    const ticks = [];
    const decades = Math.log10(high / low);
    const digits = decades < 1.2 ? [1, 2, 5] : decades < 2.5 ? [1, 3] : [1];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
      ticks.push(...digits.map((digit) => Number(`${digit}e${power}`)));
    }
    return ticks.filter((tick) => tick >= low * 0.999 && tick <= high * 1.001);
  }
  const rough = (high - low) / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  let step = [1, 2, 5, 10].map((digit) => digit * power).find((size) => size >= rough * 0.99);
  if (field.spacing === "whole") step = Math.max(1, Math.round(step));
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9); k++) ticks.push(k * step);
  return ticks;
}

// A number to three or four digits.
function short(value) {
  if (!Number.isFinite(value)) return "unknown";
  if (Number.isInteger(value) && Math.abs(value) < 1e7) return String(value);
  const size = Math.abs(value);
  return size >= 1e-3 && size < 1e5 ? String(Number(value.toPrecision(4))) : value.toExponential(2);
}
