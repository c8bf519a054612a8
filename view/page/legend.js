// SPDX-License-Identifier: Apache-2.0
// What the colours mean: a bar with ticks, the zero line, and what grey is.
import {colorsOf, shown, ticksIn} from './colors.js';
import {element} from './controls.js';
import {logTicks, shareOf} from './scale.js';

export class Legend {
  constructor(config) {
    this.same = '';
    this.unit = config.unit || 'world units';
    this.maps = config.colormaps;
    this.title = element('div', {class: 'title'});
    this.bar = element('canvas', {'aria-hidden': 'true'});
    this.ticks = element('div', {class: 'ticks'});
    this.beyond = element('div', {class: 'beyond'}, element('i'), 'beyond the band');
    this.lines = element('div', {class: 'lines'});
    this.element = element('figure', {class: 'legend', 'aria-label': 'colours'}, this.title,
      element('div', {class: 'scale'}, this.bar, this.ticks), this.beyond, this.lines);
  }

  /// `view`: as viewsOf() makes them; `lies`: the bar lies along the picture's lower side.
  show(view, lies, small) {
    const same = view && JSON.stringify([view.range, view.colormap, view.logarithmic, view.contourStep, view.banded, lies, small]);
    if (same === this.same) return;  // most frames
    this.same = same;
    this.element.hidden = !view;
    if (!view) return;
    this.element.classList.toggle('lies', lies);
    this.title.replaceChildren(view.difference ? 'difference' : 'distance', element('span', {}, this.unit));
    this.drawBar(colorsOf(this.maps[view.colormap], 256), lies);
    const ticks = view.logarithmic ? logTicks(view, lies ? 0.14 : small ? 0.12 : 0.07) : ticksIn(view.range, small || lies ? 4 : 6);
    this.ticks.replaceChildren(...ticks.map(tick => {
      const made = element('span', {class: tick === 0 && view.zeroLine ? 'zero' : ''}, shown(tick));
      made.style.setProperty('--share', shareOf(tick, view));
      return made;
    }));
    this.beyond.hidden = !view.banded;
    this.lines.textContent = view.contourStep > 0 ? `lines every ${shown(view.contourStep)}` : '';
  }

  drawBar(bytes, lies) {
    [this.bar.width, this.bar.height] = lies ? [256, 1] : [1, 256];
    const context = this.bar.getContext('2d'), image = context.createImageData(this.bar.width, this.bar.height);
    for (let n = 0; n < 256; ++n)
      image.data.set([bytes[3 * n], bytes[3 * n + 1], bytes[3 * n + 2], 255], 4 * (lies ? n : 255 - n));
    context.putImageData(image, 0, 0);
  }
}
