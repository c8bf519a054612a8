// SPDX-License-Identifier: Apache-2.0
// What the colours mean: a bar with ticks, the zero line, and what grey is.
import {colorsOf, shown, ticksIn} from './colors.js';
import {element} from './controls.js';

export class Legend {
  constructor(config) {
    this.same = '';
    this.unit = config.unit || 'world units';
    this.maps = config.colormaps;
    this.title = element('div', {class: 'title'});
    this.bar = element('canvas', {width: 1, height: 256, 'aria-hidden': 'true'});
    this.ticks = element('div', {class: 'ticks'});
    this.beyond = element('div', {class: 'beyond'}, element('i'), 'beyond the band');
    this.lines = element('div', {class: 'lines'});
    this.element = element('figure', {class: 'legend', 'aria-label': 'colours'}, this.title,
      element('div', {class: 'scale'}, this.bar, this.ticks), this.beyond, this.lines);
  }

  /// `view`: {range, colormap, difference, contourStep, zeroLine, banded}
  show(view) {
    const same = view && JSON.stringify([view.range, view.colormap, view.contourStep, view.banded, view.rect]);
    if (same === this.same) return;  // most frames
    this.same = same;
    this.element.hidden = !view;
    if (!view) return;
    this.element.classList.toggle('small', view.rect[2] < 1 || view.rect[3] < 1);
    this.element.style.setProperty('--right', `${100 * (1 - view.rect[0] - view.rect[2])}%`);
    this.element.style.setProperty('--bottom', `${100 * view.rect[1]}%`);
    this.title.replaceChildren(view.difference ? 'difference' : 'distance', element('span', {}, this.unit));
    const context = this.bar.getContext('2d'), bytes = colorsOf(this.maps[view.colormap], 256);
    const image = context.createImageData(1, 256);
    for (let n = 0; n < 256; ++n)
      image.data.set([bytes[3 * n], bytes[3 * n + 1], bytes[3 * n + 2], 255], 4 * (255 - n));
    context.putImageData(image, 0, 0);
    const [least, greatest] = view.range;
    this.ticks.replaceChildren(...ticksIn(view.range, view.rect[2] < 1 || view.rect[3] < 1 ? 4 : 6).map(tick => {
      const share = (tick - least) / (greatest - least || 1);
      const made = element('span', {class: tick === 0 && view.zeroLine ? 'zero' : ''}, shown(tick));
      made.style.setProperty('--share', share);
      return made;
    }));
    this.beyond.hidden = !view.banded;
    this.lines.textContent = view.contourStep > 0 ? `lines every ${shown(view.contourStep)}` : '';
  }
}
