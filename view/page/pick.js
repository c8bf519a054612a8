// SPDX-License-Identifier: Apache-2.0
// What lies under a point of the picture.
import {add, scaled} from './vec.js';

/// The nearest thing that a ray (scene units) meets: {kind: 'mesh' | 'slice', name, point (world), triangle}; null for
/// nothing. What is cut away, or not shown, is not met.
export function pick(scene, camera, {from, direction}) {
  const {look} = scene, eye = camera.eye();
  let best = null, nearest = Infinity;
  const box = scene.sliceBox.map(p => scene.toScene(p)), planes = [];
  if (scene.fields.size)
    look.slices.forEach((slice, axis) => {
      if (slice.shown) planes.push([axis, scene.slicePosition(axis)]);
    });
  for (const [axis, where] of planes) {
    const t = (where - from[axis]) / direction[axis];
    const p = add(from, scaled(direction, t)), slack = 1e-9;
    if (!(t > 0 && t < nearest) || p.some((v, k) => k !== axis && (v < box[0][k] - slack || v > box[1][k] + slack))) continue;
    nearest = t;
    best = {kind: 'slice', axis, name: 'xyz'[axis], point: p, triangle: null};
  }
  const meshes = [...scene.meshes].filter(([id]) => scene.isShown(id) && !scene.bodies.has(id)).map(([, mesh]) => mesh);
  if (look.iso.shown && scene.field(0)) meshes.push(scene.surface(scene.field(0)));
  const clip = scene.clipPlane();
  const clipped = t => clip[0] * (from[0] + t * direction[0]) + clip[1] * (from[1] + t * direction[1]) + clip[2] * (from[2] + t * direction[2]) > clip[3];
  const cutAway = t => clipped(t) || look.mesh.cut && planes.length > 0 && planes.every(([axis, where]) => {
    const side = eye[axis] >= where ? 1 : -1;
    return (from[axis] + direction[axis] * t - where) * side > 0;
  });
  for (const mesh of meshes) {  // but for bodies: what moves is watched, not measured
    const hit = mesh.hit(scene.toWorld(from), direction.map(v => v / scene.scale), t => t < nearest && !cutAway(t));
    if (!hit) continue;
    nearest = hit.along;
    best = {kind: 'mesh', name: mesh.name, point: add(from, scaled(direction, nearest)),
      triangle: mesh.simplified ? null : hit.triangle};
  }
  return best && {...best, scene: best.point, point: scene.toWorld(best.point)};
}
