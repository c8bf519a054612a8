// SPDX-License-Identifier: Apache-2.0
// The part of the panel that says which colours stand for which values, with how many samples have which.
import {colorsOf, shown} from './colors.js';
import {Section, element} from './controls.js';
import {kInfinite, kNoNumber} from './field_data.js';
import {shareOf} from './scale.js';

const kBins = 62, kMost = 200000;  // samples that are counted

/// How many samples of a field have a colour in each of so many parts of its scale; what is beyond the band is in none.
export function histogramOf(field, scale) {
  const bins = new Float64Array(kBins), stride = Math.max(1, Math.floor(field.codes.length / kMost)) | 1;
  for (let n = 0; n < field.codes.length; n += stride) {
    const code = field.codes[n], size = Math.abs(code);
    if (code === kNoNumber || size === kInfinite || (field.clamped && size >= field.clamped)) continue;
    ++bins[Math.min(kBins - 1, Math.floor(shareOf(code * field.step, scale) * kBins))];
  }
  return bins;
}

/// Adds to `controls`: colormap, range, limits, logarithmic, and `showScale(view)`, which follows what is drawn.
export function colorSection(viewer, controls) {
  const {look, scene, config} = viewer, section = new Section('Colours'), changed = () => viewer.changed();
  controls.colormap = section.choice({label: 'Map', value: look.colormap, changed: v => { look.colormap = v; changed(); },
    options: [['auto', 'Auto'], ['viridis', 'Viridis'], ['diverging', 'Diverging'], ['thesis', 'Thesis']]});
  const canvas = element('canvas', {class: 'histogram', width: 2 * kBins, height: 40, role: 'img', 'aria-label': 'how many samples have which colour'});
  section.body.append(canvas);
  controls.limits = section.numbers({label: 'From, to', names: ['least value of the colours', 'greatest value of the colours'], values: ['', ''],
    changed: ([a, b]) => {
      if (a < b) look.range = [a, b];
      changed();
    }});
  controls.range = section.slider({label: 'Range', least: 0.02, value: look.rangeShare, show: v => `${Math.round(100 * v)} %`,
    changed: v => { look.rangeShare = v; look.range = null; changed(); }});
  controls.logarithmic = section.toggle({label: 'Logarithmic', value: look.logarithmic, changed: v => { look.logarithmic = v; changed(); }});
  section.body.append(viewer.panelLegends);
  let drawn = '';
  controls.showScale = view => {
    const field = scene.field(0), said = JSON.stringify([view.range, view.colormap, view.logarithmic]);
    if (!field || said === drawn) return;
    drawn = said;
    controls.limits.set(view.range.map(v => shown(v)));
    drawHistogram(canvas, histogramOf(field, view), colorsOf(config.colormaps[view.colormap], kBins));
  };
  return section;
}

function drawHistogram(canvas, bins, colors) {
  const context = canvas.getContext('2d'), {width, height} = canvas, most = Math.max(...bins, 1);
  context.clearRect(0, 0, width, height);
  bins.forEach((count, n) => {
    context.fillStyle = `rgb(${colors.slice(3 * n, 3 * n + 3).join(' ')})`;
    // Roots: what few samples have is seen too.
    const high = count > 0 ? Math.max(1, Math.round(Math.sqrt(count / most) * height)) : 0;
    context.fillRect(2 * n, height - high, 2, high);
  });
}
