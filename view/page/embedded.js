// SPDX-License-Identifier: Apache-2.0
// Where a page's data comes from. A source is called with the viewer and the page's configuration; here: out of the page.
import {fromBase64, unpacked} from './blob.js';

/// By name; others add theirs.
export const sources = {
  async embedded(viewer) {
    const parts = [...document.querySelectorAll('script.data')];
    const blobs = await Promise.all(parts.map(part => unpacked(fromBase64(part.textContent))));
    for (const part of parts) part.remove();  // the text takes more memory than what it became
    for (const [n, blob] of blobs.entries()) await (kinds[blob.header.kind] ?? kinds.unknown)(viewer, `${n}`, blob);
  },
};

/// What is done with embedded data of a kind; others add theirs.
export const kinds = {
  mesh: (viewer, id, blob) => viewer.setUnpacked(id, blob),
  field: (viewer, id, blob) => viewer.setUnpacked(id, blob),
  unknown: (viewer, id, blob) => { throw new Error(`this page does not know what a ${blob.header.kind} is`); },
};
