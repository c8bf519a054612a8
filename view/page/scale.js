// SPDX-License-Identifier: Apache-2.0
// Which part of a colour map stands for a value: in shaders, and for legends and histograms.
import {niceBelow} from './colors.js';

// A logarithmic scale begins at zero, so it is linear for the last two decades below the greatest value.
const kDecades = 99;

/// `scale`: {range: [least, greatest], diverging, logarithmic}. A diverging one has the middle of the map at 0, if 0 is in
/// the range.
export const kScaleShader = `
uniform vec2 range;
uniform bool diverging, logarithmic;
float bent(float s) {
  s = clamp(s, 0.0, 1.0);
  return logarithmic ? log(1.0 + ${kDecades}.0 * s) / log(1.0 + ${kDecades}.0) : s;
}
float share_of(float value) {
  if (!diverging || range.x >= 0.0 || range.y <= 0.0) return bent((value - range.x) / (range.y - range.x));
  return value < 0.0 ? 0.5 - 0.5 * bent(value / range.x) : 0.5 + 0.5 * bent(value / range.y);
}
`;

const bent = (share, logarithmic) => {
  const s = Math.min(1, Math.max(0, share));
  return logarithmic ? Math.log1p(kDecades * s) / Math.log1p(kDecades) : s;
};

/// Where in the map, from 0 to 1, a value's colour is.
export function shareOf(value, {range: [least, greatest], diverging, logarithmic}) {
  if (!diverging || least >= 0 || greatest <= 0) return bent((value - least) / (greatest - least), logarithmic);
  return value < 0 ? 0.5 - 0.5 * bent(value / least, logarithmic) : 0.5 + 0.5 * bent(value / greatest, logarithmic);
}

/// Values to name beside a bar, of a logarithmic scale: 0 and some of 1, 2 and 5 times powers of ten, farther apart on the
/// bar than `apart`.
export function logTicks(scale, apart) {
  const [least, greatest] = scale.range, ticks = least <= 0 && greatest >= 0 ? [0] : [];
  const far = v => ticks.every(t => Math.abs(shareOf(t, scale) - shareOf(v, scale)) > apart);
  for (const [side, most] of [[1, greatest], [-1, -least]])
    for (let v = most > 0 ? niceBelow(most) : 0, n = 0; v > 0 && n < 12; v = niceBelow(v * 0.999), ++n)
      if (side * v >= least && far(side * v)) ticks.push(side * v);
  return ticks;
}
