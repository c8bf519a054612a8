// SPDX-License-Identifier: Apache-2.0
// The buttons over the picture: all in the picture, a picture as a file, dark or light, help, the panel on a phone.
import {element, svg} from './controls.js';

const kIcons = {
  frame: 'M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4M10 7v6M7 10h6',
  picture: 'M10 3v9M6.5 8.5 10 12l3.5-3.5M3 13v4h14v-4',
  link: 'M8.5 11.5a3 3 0 0 0 4.2 0l2.6-2.6a3 3 0 0 0-4.2-4.2L10 5.8M11.5 8.5a3 3 0 0 0-4.2 0l-2.6 2.6a3 3 0 0 0 4.2 4.2L10 14.2',
  theme: 'M10 3a7 7 0 1 0 0 14zM10 3a7 7 0 0 1 0 14',
  help: 'M7.4 7.6a2.7 2.7 0 1 1 3.9 2.4c-.9.5-1.3 1-1.3 2M10 15.2v.1',
  panel: 'M3 5.5h14M3 10h14M3 14.5h14',
};

export class Toolbar {
  constructor(viewer) {
    this.viewer = viewer;
    const button = (icon, label, pressed) => element('button', {type: 'button', 'aria-label': label, title: label, click: pressed},
      svg('svg', {viewBox: '0 0 20 20', 'aria-hidden': 'true'}, svg('path', {d: kIcons[icon]})));
    this.panelButton = button('panel', 'controls', () => this.togglePanel());
    this.panelButton.id = 'panel-button';
    this.element = element('div', {id: 'toolbar', role: 'toolbar', 'aria-label': 'picture'},
      button('frame', 'all in the picture', () => viewer.frame()),
      button('picture', 'save the picture', () => this.save()),
      button('link', 'link to this view', () => viewer.keepView()),
      button('theme', 'dark or light', () => this.toggleTheme()),
      button('help', 'help', () => viewer.help.toggle()), this.panelButton);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => viewer.readTheme());
  }

  toggleTheme() {
    const root = document.documentElement;
    const dark = root.dataset.theme ? root.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
    root.dataset.theme = dark ? 'light' : 'dark';
    this.viewer.readTheme();
  }

  togglePanel() {
    const open = document.body.classList.toggle('open');
    this.panelButton.setAttribute('aria-expanded', open);
  }

  /// The picture on its background, without what lies over it.
  async save() {
    const {viewer} = this, {canvas} = viewer;
    viewer.changed();
    await viewer.settled();
    viewer.renderer.showAgain();
    const drawn = element('canvas', {width: canvas.width, height: canvas.height}), context = drawn.getContext('2d');
    context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--ground');
    context.fillRect(0, 0, drawn.width, drawn.height);
    context.drawImage(canvas, 0, 0);
    drawn.toBlob(blob => {
      const url = URL.createObjectURL(blob);
      element('a', {href: url, download: 'standoff.png'}).click();
      setTimeout(() => URL.revokeObjectURL(url), 1000);
    });
  }
}
