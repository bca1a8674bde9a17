// Vectors of three and matrices of four by four, column by column.

const add = (a, b) => a.map((x, k) => x + b[k]);
const subtract = (a, b) => a.map((x, k) => x - b[k]);
const times = (a, s) => a.map((x) => x * s);
const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const cross = (a, b) => [0, 1, 2].map((k) => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

function product(a, b) {
  return Array.from({ length: 16 }, (_, i) => {
    const [row, column] = [i % 4, Math.floor(i / 4)];
    return [0, 1, 2, 3].reduce((sum, k) => sum + a[row + 4 * k] * b[k + 4 * column], 0);
  });
}

// From the drawing to the eye's axes: right, up, towards the eye.
function lookFrom(eye, right, up, toward) {
  const axes = [right, up, toward];
  const columns = [0, 1, 2].flatMap((k) => [...axes.map((axis) => axis[k]), 0]);
  return [...columns, ...axes.map((axis) => -dot(axis, eye)), 1];
}

// A perspective with the tangents of half the angles of view.
function perspective(across, upward, near, far) {
  const depth = near - far;
  return [
    1 / across, 0, 0, 0,
    0, 1 / upward, 0, 0,
    0, 0, (far + near) / depth, -1,
    0, 0, (2 * far * near) / depth, 0,
  ];
}
