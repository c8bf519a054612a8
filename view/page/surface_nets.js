// SPDX-License-Identifier: Apache-2.0
// The surface on which a field has a value: a vertex in every cell that it crosses (surface nets, Gibson 1998), in the
// middle of the crossings on the cell's edges.
import {kInfinite, kNoNumber} from './field_data.js';
import {MeshData} from './mesh_data.js';

class Growing {
  constructor(kind) { this.data = new kind(1 << 14); this.count = 0; }
  push(...values) {
    if (this.count + values.length > this.data.length) {
      const larger = new this.data.constructor(2 * this.data.length);
      larger.set(this.data);
      this.data = larger;
    }
    for (const v of values) this.data[this.count++] = v;
  }
  get all() { return this.data.subarray(0, this.count); }
}

/// As a mesh of the page: coordinates in largest spacings from the grid's origin.
export function surfaceOf(field, value) {
  const level = value / field.step, [nx, ny, nz] = field.size, unit = Math.max(...field.spacing);
  const scale = field.spacing.map(v => v / unit);
  const places = new Growing(Float32Array), corners = new Growing(Uint32Array), cells = new Growing(Uint16Array);
  let here = new Int32Array(nx * ny), below = new Int32Array(nx * ny);  // vertices of this layer of cells and the last
  const block = new Float64Array(9 * 9 * 2), eight = new Float64Array(8);
  // Stale entries of other layers are told by the cell that their vertex is in.
  const vertex = (layer, i, j, k) => {
    const id = layer[i + nx * j];
    return id < cells.count / 3 && cells.data[3 * id] === i && cells.data[3 * id + 1] === j && cells.data[3 * id + 2] === k ? id : -1;
  };
  const quad = (a, b, c, d, turned) => {
    if (a < 0 || b < 0 || c < 0 || d < 0) return;
    if (turned) corners.push(a, c, b, a, d, c); else corners.push(a, b, c, a, c, d);
  };
  for (const layer of layersOf(field, level)) {
    for (let dk = 0; dk < 8; ++dk) {
      const k = 8 * layer.z + dk;
      if (k + 1 >= nz) break;
      [here, below] = [below, here];
      for (const [tx, ty] of layer.tiles) {
        const wide = Math.min(8, nx - 1 - 8 * tx), high = Math.min(8, ny - 1 - 8 * ty);
        for (let z = 0, n = 0; z < 2; ++z)
          for (let y = 0; y < 9; ++y)
            for (let x = 0; x < 9; ++x, ++n) block[n] = x <= wide && y <= high ? field.code(8 * tx + x, 8 * ty + y, k + z) : 0;
        for (let y = 0; y < high; ++y)
          for (let x = 0; x < wide; ++x) {
            let inside = 0, usable = true;
            for (let c = 0; c < 8; ++c) {
              const v = block[x + (c & 1) + 9 * (y + (c >> 1 & 1)) + 81 * (c >> 2)];
              eight[c] = v;
              if (v < level) inside |= 1 << c;
              if (v === kNoNumber || v === kInfinite || v === -kInfinite) usable = false;
            }
            if (inside === 0 || inside === 255 || !usable) continue;
            const i = 8 * tx + x, j = 8 * ty + y;
            let sx = 0, sy = 0, sz = 0, crossings = 0;
            for (let a = 0; a < 8; ++a)
              for (let axis = 0; axis < 3; ++axis) {
                const b = a | 1 << axis;
                if (b === a || (inside >> a & 1) === (inside >> b & 1)) continue;
                const t = (level - eight[a]) / (eight[b] - eight[a]);
                sx += (a & 1) + (axis === 0 ? t : 0);
                sy += (a >> 1 & 1) + (axis === 1 ? t : 0);
                sz += (a >> 2) + (axis === 2 ? t : 0);
                ++crossings;
              }
            here[i + nx * j] = cells.count / 3;
            cells.push(i, j, k);
            places.push((i + sx / crossings) * scale[0], (j + sy / crossings) * scale[1], (k + sz / crossings) * scale[2]);
            const first = inside & 1, me = vertex(here, i, j, k);
            if ((inside >> 1 & 1) !== first && j > 0 && k > 0)
              quad(me, vertex(here, i, j - 1, k), vertex(below, i, j - 1, k - 1), vertex(below, i, j, k - 1), !first);
            if ((inside >> 2 & 1) !== first && i > 0 && k > 0)
              quad(me, vertex(below, i, j, k - 1), vertex(below, i - 1, j, k - 1), vertex(here, i - 1, j, k), !first);
            if ((inside >> 4 & 1) !== first && i > 0 && j > 0)
              quad(me, vertex(here, i - 1, j, k), vertex(here, i - 1, j - 1, k), vertex(here, i, j - 1, k), !first);
          }
      }
    }
  }
  const made = Object.create(MeshData.prototype);
  return Object.assign(made, {
    name: 'the isosurface', bits: 24, origin: field.origin, step: unit, lattice: places.all.slice(), corners: corners.all.slice(),
    vertices: places.count / 3, triangles: corners.count / 3, proxy: 0, simplified: true, box: field.box, chunks: null,
  });
}

// The tiles with a cell that the surface may cross, in layers from below: {z, tiles: [[x, y], ..]}. A cell belongs to the
// tile of its first corner, and reaches into those after it.
function layersOf(field, level) {
  const [tx, ty, tz] = field.tileCount, {slots, least, greatest, outside} = field, layers = [];
  const rangeOf = tile => {
    const slot = slots[tile];
    return slot >= 0 ? [least[slot], greatest[slot]] : slot === -1 ? [outside, outside] : [-outside, -outside];
  };
  for (let z = 0; z < tz; ++z) {
    const tiles = [];
    for (let y = 0; y < ty; ++y)
      for (let x = 0; x < tx; ++x) {
        let low = Infinity, high = -Infinity;
        for (let n = 0; n < 8; ++n) {
          const at = [x + (n & 1), y + (n >> 1 & 1), z + (n >> 2)];
          if (at[0] >= tx || at[1] >= ty || at[2] >= tz) continue;
          const [a, b] = rangeOf(at[0] + tx * (at[1] + ty * at[2]));
          if (a < low) low = a;
          if (b > high) high = b;
        }
        if (low < level && high >= level) tiles.push([x, y]);
      }
    if (tiles.length) layers.push({z, tiles});
  }
  return layers;
}
