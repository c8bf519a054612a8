// SPDX-License-Identifier: Apache-2.0
// What moves slices along their axes: round handles, and the planes themselves with Alt. The panel's sliders do the same for keyboards and screen readers.
import {element} from './controls.js';
import {clamp} from './vec.js';

export class SliceHandles {
  constructor(viewer) {
    this.viewer = viewer;
    this.handles = [...'xyz'].map((name, axis) => {
      const handle = element('div', {class: `handle ${name}`, hidden: true, title: `move the slice across ${name}`}, name);
      handle.addEventListener('pointerdown', e => {
        handle.setPointerCapture(e.pointerId);
        const view = viewer.views()[0], corner = this.cornerOf(axis, view);
        this.move = corner && this.mover(axis, view, corner.corner, e);
      });
      handle.addEventListener('pointermove', e => { if (handle.hasPointerCapture(e.pointerId)) this.move?.(e); });
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

  /// What moves the slice that is under a pixel of the canvas; null where there is none.
  moverAt(px, py, e) {
    const {viewer} = this, found = viewer.probe(px, py);
    return found?.kind === 'slice' ? this.mover(found.axis, viewer.rayAt(px, py).view, found.scene, e) : null;
  }

  // A function that moves a slice so that `anchor`, a point of it (scene units), follows a pointer that began with `from`.
  mover(axis, view, anchor, from) {
    const {viewer} = this, {scene, look} = viewer, slice = look.slices[axis], began = slice.at;
    // How far the point would move on the picture if the slice moved through the whole box.
    const box = scene.sliceBox.map(p => scene.toScene(p)), ends = [0, 1].map(side => {
      const p = [...anchor];
      p[axis] = box[side][axis];
      return viewer.placeOf(p, view);
    });
    if (!ends[0] || !ends[1]) return null;
    const way = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]], squared = Math.max(way[0] ** 2 + way[1] ** 2, 400);
    return e => {
      const share = ((e.clientX - from.clientX) * way[0] + (e.clientY - from.clientY) * way[1]) / squared;
      slice.at = clamp(began + share, 0, 1);
      viewer.controls.slices?.[axis].place.set(slice.at);
      viewer.changed();
    };
  }
}
