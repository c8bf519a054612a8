// SPDX-License-Identifier: Apache-2.0
// Which fields are shown side by side, where, and in which colours.
import {niceStep} from './colors.js';

const kComparisons = {first: [[0]], second: [[1]], both: [[0], [1]], all: [[0], [1], [0, 1]], difference: [[0, 1]]};
const kNearest = 10, kFarthest = 60;  // pixels between contour lines, where a field is seen face to face

/// The views of a comparison: {fields, difference, label, range, diverging, logarithmic, colormap, contourStep, zeroLine,
/// banded, rect}; a rect is in parts of the picture, from its lower left. `look`: {comparison, colormap, range, rangeShare,
/// logarithmic, contours}; `size`: of the picture, pixels; `pixelsOf(rect)`: of a world unit, about where one looks.
export function viewsOf(scene, look, size, pixelsOf) {
  const wanted = scene.fields.size < 2 ? [scene.fields.size ? [0] : []] : kComparisons[look.comparison];
  const rects = arranged(wanted.length, ...size);
  return wanted.map((numbers, n) => {
    const fields = numbers.map(k => scene.field(k)), difference = fields.length === 2;
    const view = {
      fields, difference, banded: fields.some(f => f.clamped > 0), logarithmic: look.logarithmic, rect: rects[n],
      label: wanted.length < 2 ? '' : difference ? `${fields[0].name} − ${fields[1].name}` : fields[0].name,
    };
    view.diverging = difference || (fields.length > 0 && fields[0].signed);
    view.colormap = look.colormap === 'auto' || difference ? (view.diverging ? 'diverging' : 'viridis') : look.colormap;
    view.range = !difference && look.range || wholeRange(scene, fields, view.diverging, look.rangeShare);
    // A difference is noise where fields agree: lines would show it as if it were more.
    view.zeroLine = view.diverging && !difference;
    const apart = pixels => niceStep(pixels / pixelsOf(view.rect), 1, true);
    view.contourStep = look.contours && fields.length > 0 && !difference
      ? Math.max(apart(kNearest), Math.min(apart(kFarthest), niceStep(view.range[1] - view.range[0], 24))) : 0;
    return view;
  });
}

// Rows of pictures, from the upper left, in which each is as large as can be.
function arranged(count, width, height) {
  let columns = 1;
  const smaller = c => Math.min(width / c, height / Math.ceil(count / c));
  for (let c = 2; c <= count; ++c) if (smaller(c) > smaller(columns)) columns = c;
  const rows = Math.ceil(count / columns);
  return Array.from({length: count}, (_, n) =>
    [n % columns / columns, 1 - (Math.floor(n / columns) + 1) / rows, 1 / columns, 1 / rows]);
}

function wholeRange(scene, fields, diverging, share) {
  const [least, greatest] = fields.length === 2 ? differenceRange(scene, ...fields) : fields.length ? rangeOf(scene, fields[0]) : [0, 1];
  const most = Math.max(Math.abs(least), Math.abs(greatest)) * share || 1e-30;
  return diverging ? [-most, most] : [least, least + ((greatest - least) * share || 1)];
}

// Of both fields where there are two: the same colour is then the same value.
function rangeOf(scene, field) {
  const fields = scene.fields.size === 2 ? [...scene.fields.values()] : [field];
  return [Math.min(...fields.map(f => f.range[0])), Math.max(...fields.map(f => f.range[1]))];
}

const known = new WeakMap();
// The greatest difference at some thousand samples of the first field that both know.
function differenceRange(scene, a, b) {
  if (known.get(a)?.other === b) return known.get(a).range;
  let most = 0;
  const steps = a.size.map(n => Math.max(1, Math.floor(n / 24)));
  for (let k = 0; k < a.size[2]; k += steps[2])
    for (let j = 0; j < a.size[1]; j += steps[1])
      for (let i = 0; i < a.size[0]; i += steps[0]) {
        const there = b.at([i, j, k].map((v, axis) => a.origin[axis] + v * a.spacing[axis]));
        if (!there || there.clamped || a.isClamped(i, j, k)) continue;
        const difference = Math.abs(a.value(i, j, k) - there.value);
        if (Number.isFinite(difference)) most = Math.max(most, difference);
      }
  const range = [-most || -a.step, most || a.step];
  known.set(a, {other: b, range});
  return range;
}
