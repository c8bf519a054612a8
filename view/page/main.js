// SPDX-License-Identifier: Apache-2.0
// Starts the page.
import {sources} from './embedded.js';
import {showFragment} from './link.js';
import {Viewer} from './viewer.js';

async function main() {
  const config = JSON.parse(document.getElementById('config').textContent);
  document.title = config.title;
  document.getElementById('names').textContent = config.title;
  try {
    const viewer = globalThis.viewer = new Viewer(config);
    await sources[config.source](viewer, config);
    showFragment(viewer, location.hash);
    addEventListener('hashchange', () => showFragment(viewer, location.hash));
    viewer.renderer.complete = true;
    document.body.classList.add('ready');
    await viewer.settled();
    document.body.classList.add('settled');
  } catch (error) {
    const told = document.getElementById('failure');
    told.hidden = false;
    told.textContent = error.message;
    throw error;
  }
}
main();
