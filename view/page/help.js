// SPDX-License-Identifier: Apache-2.0
// Keys, and the overlay that lists them with what pointers and fingers do.
import {element} from './controls.js';

const kGestures = [
  ['drag', 'turn'], ['right drag, Shift + drag', 'move'], ['wheel, pinch', 'nearer, farther'], ['two fingers', 'move'],
  ['click, tap', 'read the value there'], ['double click', 'turn about that point'], ['drag a round handle', 'move that slice'],
  ['Alt + drag on a slice', 'move that slice'],
];

/// `actions`: [keys, words, action] of the page; `extra`: the same of others, looked at anew each time.
export class Help {
  constructor(actions, extra) {
    this.actions = () => [...actions, ...extra];
    this.dialog = element('dialog', {id: 'help', 'aria-label': 'help'});
    this.dialog.addEventListener('click', e => { if (e.target === this.dialog) this.dialog.close(); });
    addEventListener('keydown', e => this.key(e));
  }

  key(e) {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const inControl = e.target.matches?.('input, select, textarea, summary, button');
    if (inControl && (e.key.startsWith('Arrow') || e.key === ' ' || e.key === 'Enter' || /^(Page|Home|End)/.test(e.key))) return;
    if (e.target.matches?.('input[type=text], input[type=number], textarea')) return;
    if (this.dialog.open && e.key !== '?') return;
    const found = this.actions().find(([keys]) => keys.includes(e.key));
    if (!found) return;
    e.preventDefault();
    found[2](e);
  }

  toggle() {
    if (this.dialog.open) return this.dialog.close();
    const list = rows => element('dl', {}, ...rows.flatMap(([name, words]) => [element('dt', {}, ...name), element('dd', {}, words)]));
    const names = {ArrowLeft: '←', ArrowRight: '→', ArrowUp: '↑', ArrowDown: '↓', ' ': 'Space'};
    const keys = this.actions().filter(([, words]) => words).map(([keys, words]) => [keys.map(k => element('kbd', {}, names[k] ?? k)), words]);
    this.dialog.replaceChildren(
      element('div', {class: 'columns'},
        element('section', {}, element('h2', {}, 'Mouse and fingers'), list(kGestures.map(([name, words]) => [[name], words]))),
        element('section', {}, element('h2', {}, 'Keys'), list(keys))),
      element('form', {method: 'dialog'}, element('button', {class: 'button'}, 'Close')));
    this.dialog.showModal();
  }
}
