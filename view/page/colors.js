// SPDX-License-Identifier: Apache-2.0
// Colours of values: the maps of the program's pictures, and numbers for people.

/// The colours of a map at n even steps, as bytes red, green, blue; `text`: hexadecimal digits at 33 steps.
export function colorsOf(text, n) {
  const known = text.match(/../g).map(pair => parseInt(pair, 16)), last = known.length / 3 - 1;
  const bytes = new Uint8Array(3 * n);
  for (let step = 0; step < n; ++step) {
    const at = step / (n - 1) * last, below = Math.min(Math.floor(at), last - 1), share = at - below;
    for (let c = 0; c < 3; ++c)
      bytes[3 * step + c] = Math.round(known[3 * below + c] * (1 - share) + known[3 * below + 3 + c] * share);
  }
  return bytes;
}

export function colorTexture(gl, bytes) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, bytes.length / 3, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, bytes);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.LINEAR);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
  return texture;
}

/// 1, 2 or 5 times a power of ten, so that about `count` steps make `span`; with `above` no more than so many.
export function niceStep(span, count, above = false) {
  if (!(span > 0) || !Number.isFinite(span)) return 1;
  const raw = span / count, power = 10 ** Math.floor(Math.log10(raw)), lead = raw / power;
  const [one, two, five] = above ? [1, 2, 5] : [1.5, 3.5, 7.5];
  return (lead <= one ? 1 : lead <= two ? 2 : lead <= five ? 5 : 10) * power;
}

/// 1, 2 or 5 times a power of ten that is not above a value.
export function niceBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value)), lead = value / power;
  return (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * power;
}

/// Multiples of a nice step in a range.
export function ticksIn([least, greatest], count) {
  const step = niceStep(greatest - least, count), ticks = [];
  for (let n = Math.ceil(least / step - 1e-9); n <= greatest / step + 1e-9; ++n) ticks.push(n === 0 ? 0 : n * step);
  return ticks;
}

/// A number in so many significant digits, with a true minus sign: "−0.0125".
export function shown(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  const size = Math.abs(value);
  let text;
  if (size !== 0 && (size < 1e-4 || size >= 1e6)) {
    const [lead, power] = value.toExponential(digits - 1).split('e');
    text = `${lead.replace(/\.?0+$/, '')}e${Number(power)}`;
  } else {
    text = String(Number(value.toPrecision(digits)));
  }
  return text.replace(/-/g, '−');
}

/// "1,234,567".
export const grouped = n => String(n).replace(/\B(?=(\d{3})+$)/g, ',');  // what browsers have for it takes them long to load

/// A CSS colour as four numbers from 0 to 1.
export function parsedColor(text) {
  const canvas = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
  canvas.fillStyle = text;
  canvas.fillRect(0, 0, 1, 1);
  return [...canvas.getImageData(0, 0, 1, 1).data].map(v => v / 255);
}

/// Red, green and blue from 0 to 1 as "#rrggbb".
export const hexOf = color => '#' + color.slice(0, 3).map(v => Math.round(255 * v).toString(16).padStart(2, '0')).join('');
