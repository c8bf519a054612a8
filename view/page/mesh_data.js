// SPDX-License-Identifier: Apache-2.0
// A mesh as the page got it: corners on a lattice, triangles, and fewer triangles to draw while the camera moves.
import {fromPlanes, fromVarints, fromZigzag} from './blob.js';

const kChunk = 512;  // triangles that share a box, for rays

export class MeshData {
  constructor({header, section}) {
    Object.assign(this, header);
    const bytes = section('positions'), planes = this.bits / 8 + 1, count = this.vertices;
    this.lattice = this.bits === 16 ? new Uint16Array(3 * count) : new Float32Array(3 * count);
    const most = [0, 0, 0];
    for (let axis = 0; axis < 3; ++axis) {
      const deltas = fromPlanes(bytes.subarray(axis * planes * count), count, planes);
      let last = 0;
      for (let n = 0; n < count; ++n) {
        last += fromZigzag(deltas[n]);
        this.lattice[3 * n + axis] = last;
        if (last > most[axis]) most[axis] = last;
      }
    }
    this.box = [this.origin, this.origin.map((v, k) => v + most[k] * this.step)];
    this.corners = fromVarints(section('triangles'), 3 * this.triangles);
    for (let n = 0, next = 0; n < this.corners.length; ++n)
      if ((this.corners[n] = next - this.corners[n]) === next) ++next;
    this.proxyCorners = fromVarints(section('proxy'), 3 * this.proxy);
    for (let n = 0, last = 0; n < this.proxyCorners.length; ++n)
      this.proxyCorners[n] = last += fromZigzag(this.proxyCorners[n]);
    this.chunks = null;
  }

  /// In world units.
  vertex(n) { return [0, 1, 2].map(k => this.origin[k] + this.lattice[3 * n + k] * this.step); }
  triangle(n) { return [0, 1, 2].map(k => this.vertex(this.corners[3 * n + k])); }

  /// The first triangle that a ray hits, and how far along the ray (in lengths of `direction`); world units.
  /// `accepts` says of a distance whether a hit there counts.
  hit(from, direction, accepts = () => true) {
    const o = from.map((v, k) => (v - this.origin[k]) / this.step), d = direction.map(v => v / this.step);
    this.chunks ??= this.boxesOfChunks();
    let best = null, nearest = Infinity;
    for (let chunk = 0; 6 * chunk < this.chunks.length; ++chunk) {
      if (!entersBox(this.chunks, 6 * chunk, o, d, nearest)) continue;
      const end = Math.min(this.triangles, (chunk + 1) * kChunk);
      for (let n = chunk * kChunk; n < end; ++n) {
        const t = this.distanceTo(n, o, d);
        if (t < nearest && accepts(t)) [nearest, best] = [t, n];
      }
    }
    return best === null ? null : {triangle: best, along: nearest};
  }

  // Möller and Trumbore; Infinity for a miss.
  distanceTo(n, o, d) {
    const p = this.lattice, a = 3 * this.corners[3 * n], b = 3 * this.corners[3 * n + 1], c = 3 * this.corners[3 * n + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const hx = d[1] * vz - d[2] * vy, hy = d[2] * vx - d[0] * vz, hz = d[0] * vy - d[1] * vx;
    const determinant = ux * hx + uy * hy + uz * hz;
    if (determinant === 0) return Infinity;
    const sx = o[0] - p[a], sy = o[1] - p[a + 1], sz = o[2] - p[a + 2];
    const s = (sx * hx + sy * hy + sz * hz) / determinant;
    if (s < 0 || s > 1) return Infinity;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const r = (d[0] * qx + d[1] * qy + d[2] * qz) / determinant;
    if (r < 0 || s + r > 1) return Infinity;
    const t = (vx * qx + vy * qy + vz * qz) / determinant;
    return t > 0 ? t : Infinity;
  }

  boxesOfChunks() {
    const boxes = new Float32Array(6 * Math.ceil(this.triangles / kChunk));
    for (let chunk = 0; 6 * chunk < boxes.length; ++chunk) {
      const box = boxes.subarray(6 * chunk, 6 * chunk + 6).fill(Infinity, 0, 3).fill(-Infinity, 3);
      const end = Math.min(this.corners.length, 3 * (chunk + 1) * kChunk);
      for (let n = 3 * chunk * kChunk; n < end; ++n)
        for (let k = 0; k < 3; ++k) {
          const v = this.lattice[3 * this.corners[n] + k];
          if (v < box[k]) box[k] = v;
          if (v > box[3 + k]) box[3 + k] = v;
        }
    }
    return boxes;
  }
}

function entersBox(boxes, at, o, d, most) {
  let enter = 0, leave = most;
  for (let k = 0; k < 3; ++k) {
    const a = (boxes[at + k] - o[k]) / d[k], b = (boxes[at + 3 + k] - o[k]) / d[k];
    // In a plane of the box, 0/0: the other axes decide.
    if (a < b) { if (a > enter) enter = a; if (b < leave) leave = b; }
    else if (b <= a) { if (b > enter) enter = b; if (a < leave) leave = a; }
  }
  return enter <= leave;
}
