// Triangles as pixels, on the processor: each pixel knows its triangle, so that another field or
// another scale only looks up colours, and a pointed-at value is read off. Needs no WebGL, which
// remote desktops and browsers without a graphics card lack.

const NONE = 0; // triangles count from 1 in the pixels
const SAMPLE = 20000; // pixels that tell a range

// Fill `owners`, width x height, with the number of the triangle over each pixel's middle.
export function rasterize(owners, width, height, points, triangles, view) {
  owners.fill(NONE);
  const x = new Float64Array(points.length / 2);
  const y = new Float64Array(points.length / 2);
  for (let k = 0; k < x.length; k++) {
    x[k] = view.x(points[2 * k]);
    y[k] = view.y(points[2 * k + 1]);
  }
  for (let t = 0; t < triangles.length; t += 3) {
    let a = triangles[t], b = triangles[t + 1], c = triangles[t + 2];
    if (y[a] > y[b]) [a, b] = [b, a];
    if (y[b] > y[c]) [b, c] = [c, b];
    if (y[a] > y[b]) [a, b] = [b, a];
    const first = Math.max(0, Math.ceil(y[a] - 0.5));
    const last = Math.min(height - 1, Math.floor(y[c] - 0.5));
    if (first > last || Math.max(x[a], x[b], x[c]) < 0 || Math.min(x[a], x[b], x[c]) > width) continue;
    const slope = (x[c] - x[a]) / (y[c] - y[a]); // of the long side
    for (let row = first; row <= last; row++) {
      const middle = row + 0.5;
      const along = x[a] + slope * (middle - y[a]);
      const [p, q] = middle < y[b] ? [a, b] : [b, c];
      const rise = y[q] - y[p];
      const other = rise > 0 ? x[p] + ((x[q] - x[p]) * (middle - y[p])) / rise : x[q];
      const left = Math.max(0, Math.ceil(Math.min(along, other) - 0.5));
      const right = Math.min(width - 1, Math.floor(Math.max(along, other) - 0.5));
      if (left <= right) owners.fill(t / 3 + 1, row * width + left, row * width + right + 1);
    }
  }
}

// Colour the pixels: values are divided by the scale's unit and looked up in its list of colours.
export function colour(pixels, owners, values, scale) {
  const list = scale.colours, last = list.length / 3 - 1;
  const packed = new Uint32Array(pixels.data.buffer);
  const table = new Uint32Array(values.length + 1); // of NONE: transparent
  for (let k = 0; k < values.length; k++) {
    const share = (values[k] / scale.size - scale.low) / (scale.high - scale.low);
    const place = 3 * Math.round(last * Math.min(1, Math.max(0, share)));
    table[k + 1] = Number.isNaN(share)
      ? 0xffbbbbbb
      : 0xff000000 | (list[place + 2] << 16) | (list[place + 1] << 8) | list[place];
  }
  for (let k = 0; k < packed.length; k++) packed[k] = table[owners[k]];
}

// The range of the values over the pixels, without the hundredth at either end: tips have no bound.
export function rangeOver(owners, values) {
  const step = Math.max(1, Math.floor(owners.length / SAMPLE));
  const seen = [];
  for (let k = 0; k < owners.length; k += step) {
    if (owners[k] !== NONE && Number.isFinite(values[owners[k] - 1])) seen.push(values[owners[k] - 1]);
  }
  const sorted = Float64Array.from(seen).sort();
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))];
  return sorted.length ? [at(0.01), at(0.99)] : null;
}
