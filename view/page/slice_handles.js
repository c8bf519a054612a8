// SPDX-License-Identifier: Apache-2.0
// Round handles that move slices along their axes. The panel's sliders do the same for keyboards and screen readers.
import {element} from './controls.js';
import {clamp} from './vec.js';

export class SliceHandles {
  constructor(viewer) {
    this.viewer = viewer;
    this.handles = [...'xyz'].map((name, axis) => {
      const handle = element('div', {class: `handle ${name}`, hidden: true, title: `move the slice across ${name}`}, name);
      handle.addEventListener('pointerdown', e => {
        handle.setPointerCapture(e.pointerId);
        this.from = [e.clientX, e.clientY, viewer.look.slices[axis].at];
      });
      handle.addEventListener('pointermove', e => { if (handle.hasPointerCapture(e.pointerId)) this.drag(axis, e); });
      return handle;
    });
    this.element = element('div', {id: 'handles', 'aria-hidden': 'true'}, ...this.handles);
  }

  // The corner of the plane that is lowest on the picture: there the handle hides least.
  cornerOf(axis, view) {
    const {scene} = this.viewer, box = scene.sliceBox.map(p => scene.toScene(p));
    let lowest = null;
    for (let n = 0; n < 4; ++n) {
      const corner = [0, 1, 2].map(k => box[(k === (axis + 1) % 3 ? n & 1 : n >> 1)][k]);
      corner[axis] = scene.slicePosition(axis);
      const at = this.viewer.placeOf(corner, view);
      if (at && (!lowest || at[1] > lowest.at[1])) lowest = {corner, at};
    }
    return lowest;
  }

  place(view) {
    const {look, scene, canvas} = this.viewer;
    this.handles.forEach((handle, axis) => {
      const corner = look.slices[axis].shown && scene.fields.size > 0 && this.cornerOf(axis, view);
      handle.hidden = !corner;
      if (!corner) return;
      const [x, y] = [clamp(corner.at[0], 16, canvas.clientWidth - 16), clamp(corner.at[1], 16, canvas.clientHeight - 16)];
      handle.style.transform = `translate(${x}px, ${y}px)`;
    });
  }

  drag(axis, e) {
    const {viewer} = this, {scene, look} = viewer, view = viewer.views()[0], found = this.cornerOf(axis, view);
    if (!found) return;
    // How far the corner would move on the picture if the slice moved through the whole box.
    const box = scene.sliceBox.map(p => scene.toScene(p)), ends = [0, 1].map(side => {
      const p = [...found.corner];
      p[axis] = box[side][axis];
      return viewer.placeOf(p, view);
    });
    if (!ends[0] || !ends[1]) return;
    const way = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]], squared = Math.max(way[0] ** 2 + way[1] ** 2, 400);
    const share = ((e.clientX - this.from[0]) * way[0] + (e.clientY - this.from[1]) * way[1]) / squared;
    look.slices[axis].at = clamp(this.from[2] + share, 0, 1);
    viewer.controls.slices?.[axis].place.set(look.slices[axis].at);
    viewer.changed();
  }
}
