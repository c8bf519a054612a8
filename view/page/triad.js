// SPDX-License-Identifier: Apache-2.0
// The axes of the world, in a corner of the picture. A click on one looks along it.
import {svg} from './controls.js';

const kSize = 84, kArm = 29;

export class Triad {
  /// `chosen(axis, side)`: an axis was clicked.
  constructor(chosen) {
    this.element = svg('svg', {id: 'triad', viewBox: `0 0 ${kSize} ${kSize}`, role: 'group', 'aria-label': 'look along an axis'});
    this.arms = [...'xyz'].map((name, axis) => {
      const line = svg('line', {x1: kSize / 2, y1: kSize / 2});
      const text = svg('text', {'text-anchor': 'middle', dy: '0.35em'}, name);
      const target = svg('circle', {r: 10, class: 'target'});
      const group = svg('g', {class: `axis ${name}`, tabindex: 0, role: 'button', 'aria-label': `look along ${name}`}, line, target, text);
      let side = -1;
      const look = () => chosen(axis, side = -side);
      group.addEventListener('click', look);
      group.addEventListener('keydown', e => {
        if (e.key !== 'Enter' && e.key !== ' ') return;
        e.preventDefault();
        look();
      });
      return {group, line, text, target};
    });
    this.element.append(...this.arms.map(arm => arm.group));
  }

  turn({right, upward, back}) {
    const depth = [0, 1, 2].map(axis => back[axis]);
    this.arms.forEach(({line, text, target}, axis) => {
      const x = kSize / 2 + kArm * right[axis], y = kSize / 2 - kArm * upward[axis];
      const beyond = p => kSize / 2 + (p - kSize / 2) * 1.4;
      for (const [element, names, px, py] of [[line, ['x2', 'y2'], x, y], [text, ['x', 'y'], beyond(x), beyond(y)],
        [target, ['cx', 'cy'], beyond(x), beyond(y)]]) {
        element.setAttribute(names[0], px);
        element.setAttribute(names[1], py);
      }
    });
    // What is nearer is drawn later.
    const order = [0, 1, 2].sort((a, b) => depth[a] - depth[b]).join();
    if (order === this.order) return;
    this.order = order;
    const focused = document.activeElement;
    order.split(',').forEach(axis => this.element.append(this.arms[axis].group));
    if (this.element.contains(focused)) focused.focus();
  }
}
