// SPDX-License-Identifier: Apache-2.0
// A field as the page got it: tiles of 8x8x8 whole numbers; one step is `step` world units.
import {fromPlanes, fromVarints, fromZigzag} from './blob.js';
import {clamp} from './vec.js';

export const kInfinite = 32767;
export const kNoNumber = -32768;
const kSide = 8, kSamples = 512;

export class FieldData {
  constructor({header, section}) {
    Object.assign(this, header);
    this.tileCount = this.size.map(n => Math.ceil(n / kSide));
    const plain = section('plain');
    this.codes = plain ? new Int16Array(plain.slice().buffer) : valuesOf(section('values'), this.stored);
    this.triangles = this.nearest ? nearestOf(section('nearest'), kSamples * this.stored) : null;
    const kinds = section('tiles');
    this.slots = new Int32Array(kinds.length);
    for (let n = 0, next = 0; n < kinds.length; ++n) this.slots[n] = kinds[n] === 2 ? next++ : -1 - kinds[n];
    this.outside = this.clamped || kInfinite;
    this.box = [this.origin, this.origin.map((v, k) => v + (this.size[k] - 1) * this.spacing[k])];
    this.findRange();
  }

  // The least and greatest code of each stored tile, and of all.
  findRange() {
    this.least = new Int16Array(this.stored).fill(32767);
    this.greatest = new Int16Array(this.stored).fill(-32768);
    let least = 32767, greatest = -32768;
    for (let slot = 0, n = 0; slot < this.stored; ++slot) {
      for (const end = n + kSamples; n < end; ++n) {
        const c = this.codes[n];
        if (c === kNoNumber || c === kInfinite || c === -kInfinite) continue;
        if (c < this.least[slot]) this.least[slot] = c;
        if (c > this.greatest[slot]) this.greatest[slot] = c;
      }
      least = Math.min(least, this.least[slot]);
      greatest = Math.max(greatest, this.greatest[slot]);
    }
    this.range = least <= greatest ? [least * this.step, greatest * this.step] : [0, this.clamped * this.step || 1];
  }

  /// The least value on the sides of the grid: isosurfaces of less are closed there.
  get borderLeast() {
    if (this.leastOnBorder !== undefined) return this.leastOnBorder;
    const [nx, ny, nz] = this.size;
    let least = Infinity;
    for (let k = 0; k < nz; ++k)
      for (let j = 0; j < ny; ++j) {
        const step = j === 0 || k === 0 || j === ny - 1 || k === nz - 1 ? 1 : Math.max(1, nx - 1);
        for (let i = 0; i < nx; i += step) least = Math.min(least, this.value(i, j, k));
      }
    return this.leastOnBorder = least;
  }

  // Where a sample's code lies in `codes`, or below 0 for a tile that is not stored.
  place(i, j, k) {
    const [nx, ny] = this.tileCount;
    const slot = this.slots[(i >> 3) + nx * ((j >> 3) + ny * (k >> 3))];
    return slot < 0 ? slot : kSamples * slot + (i & 7) + kSide * ((j & 7) + kSide * (k & 7));
  }
  code(i, j, k) {
    const at = this.place(i, j, k);
    return at >= 0 ? this.codes[at] : at === -2 ? -this.outside : this.outside;
  }
  /// In world units; NaN where the sample is none.
  value(i, j, k) {
    const c = this.code(i, j, k);
    return c === kNoNumber ? NaN : c === kInfinite ? Infinity : c === -kInfinite ? -Infinity : c * this.step;
  }
  isClamped(i, j, k) { return this.clamped > 0 && Math.abs(this.code(i, j, k)) >= this.clamped; }

  /// What is known at a point of the world: the value and gradient of the trilinear interpolation, the nearest sample
  /// with its nearest triangle, and whether a corner of the cell is clamped. null outside of the grid.
  at(point) {
    const u = point.map((v, k) => (v - this.origin[k]) / this.spacing[k]);
    const slack = 1e-6;
    if (u.some((v, k) => !(v >= -slack && v <= this.size[k] - 1 + slack))) return null;
    const first = u.map((v, k) => clamp(Math.floor(v), 0, Math.max(0, this.size[k] - 2)));
    const share = u.map((v, k) => clamp(v - first[k], 0, 1));
    let value = 0, clamped = false;
    const gradient = [0, 0, 0];
    for (let corner = 0; corner < 8; ++corner) {
      const on = [corner & 1, corner >> 1 & 1, corner >> 2];
      const [i, j, k] = first.map((v, axis) => Math.min(v + on[axis], this.size[axis] - 1));
      const weights = share.map((s, axis) => on[axis] ? s : 1 - s), v = this.value(i, j, k);
      const weight = weights[0] * weights[1] * weights[2];
      if (weight > 0) {
        value += weight * v;
        clamped ||= this.isClamped(i, j, k);
      }
      for (let axis = 0; axis < 3; ++axis)
        if (this.size[axis] > 1)
          gradient[axis] += (on[axis] ? v : -v) * weights[(axis + 1) % 3] * weights[(axis + 2) % 3] / this.spacing[axis];
    }
    const sample = u.map((v, k) => clamp(Math.round(v), 0, this.size[k] - 1));
    const place = this.place(...sample);
    const triangle = this.triangles && place >= 0 ? this.triangles[place] : null;
    return {value, clamped, gradient, sample, triangle: triangle === 0xffffffff ? null : triangle};
  }
}

// The other half of coded_values() in src/page/field_blob.cpp.
function valuesOf(bytes, tiles) {
  const rest = fromPlanes(bytes, kSamples * tiles, 3), codes = new Int16Array(rest.length);
  let first = 0;
  for (let tile = 0; tile < codes.length; tile += kSamples) {
    for (let n = 0; n < kSamples; ++n) {
      const c = tile + n, i = n & 7, j = n >> 3 & 7, k = n >> 6, delta = fromZigzag(rest[c]);
      let guess;
      if (i && j && k)
        guess = codes[c - 1] + codes[c - 8] + codes[c - 64] - codes[c - 9] - codes[c - 65] - codes[c - 72] + codes[c - 73];
      else if (j && k) guess = codes[c - 8] + codes[c - 64] - codes[c - 72];
      else if (i && k) guess = codes[c - 1] + codes[c - 64] - codes[c - 65];
      else if (i && j) guess = codes[c - 1] + codes[c - 8] - codes[c - 9];
      else if (i) guess = i > 1 ? 2 * codes[c - 1] - codes[c - 2] : codes[c - 1];
      else if (j) guess = j > 1 ? 2 * codes[c - 8] - codes[c - 16] : codes[c - 8];
      else if (k) guess = k > 1 ? 2 * codes[c - 64] - codes[c - 128] : codes[c - 64];
      else guess = first;
      codes[c] = guess + delta;
    }
    first = codes[tile];
  }
  return codes;
}

function nearestOf(bytes, count) {
  const triangles = fromVarints(bytes, count);
  for (let n = 0; n < count; ++n) {
    const i = n & 7, j = n >> 3 & 7, k = n >> 6 & 7;
    let guess = i ? triangles[n - 1] : j ? triangles[n - 8] : k ? triangles[n - 64] : n ? triangles[n - 1] : 0;
    if (j && k && triangles[n - 8] === triangles[n - 64]) guess = triangles[n - 8];
    triangles[n] = guess + fromZigzag(triangles[n]);
  }
  return triangles;
}
