// SPDX-License-Identifier: Apache-2.0
// Fewer triangles in place of a large mesh, to draw while something moves. A mesh may bring them along; else vertices that
// share a cell of a lattice become one (vertex clustering, Rossignac and Borrel 1993). A triangle that collapses to a line
// stays, as a line: beams and wires thinner than a cell would be gone. No vertex moves farther than a cell is wide.
import {normalsOf} from './normals.js';

/// Cells along the longest side, the coarsest first; of as many cubes as there are cells.
export const kCells = [32, 48, 64, 96, 128, 192, 256, 384, 512];

// A set of rows of whole numbers, which keeps them in the order of their coming.
class Rows {
  constructor(width) {
    Object.assign(this, {width, count: 0});
    this.rows = new Uint32Array(width << 12);
    this.table = new Int32Array(1 << 14).fill(-1);
  }

  slot(a, b, c) {
    const {rows, table, width} = this, mask = table.length - 1;
    let at = (Math.imul(a, 0x9e3779b1) ^ Math.imul(b, 0x85ebca6b) ^ Math.imul(c, 0xc2b2ae35)) >>> 0;
    for (at = (at ^ at >>> 15) & mask; table[at] >= 0; at = at + 1 & mask) {
      const row = width * table[at];
      if (rows[row] === a && rows[row + 1] === b && (width < 3 || rows[row + 2] === c)) break;
    }
    return at;
  }
  has(a, b, c = 0) { return this.table[this.slot(a, b, c)] >= 0; }
  add(a, b, c = 0) {
    const at = this.slot(a, b, c);
    if (this.table[at] >= 0) return;
    this.table[at] = this.count;
    const row = this.width * this.count++;
    this.rows[row] = a;
    this.rows[row + 1] = b;
    if (this.width > 2) this.rows[row + 2] = c;
    if (2 * this.count > this.table.length) this.grow();
  }
  grow() {
    const {rows, width} = this;
    this.table = new Int32Array(2 * this.table.length).fill(-1);
    for (let n = 0, at = 0; n < this.count; ++n, at += width)
      this.table[this.slot(rows[at], rows[at + 1], width > 2 ? rows[at + 2] : 0)] = n;
    if (width * (this.table.length / 2 + 1) < rows.length) return;
    this.rows = new Uint32Array(width * (this.table.length / 2 + 1));
    this.rows.set(rows);
  }
  get all() { return this.rows.slice(0, this.width * this.count); }
}

// For each vertex the number of its cell, counted by first appearance; and how many there are. Cells are around the points of
// a body-centred lattice: of all lattices its cells reach least far for what they hold. Points of it are the mesh's corners.
function clustersOf(lattice, vertices, most, cells) {
  const share = cells / 1.26 / (most + 1), side = Math.ceil(cells / 1.26) + 1, cluster = new Uint32Array(vertices);
  let table = new Int32Array(1 << 14).fill(-1), keys = new Int32Array(1 << 13), count = 0;
  const find = key => {
    let at = Math.imul(key, 0x9e3779b1) >>> 0;
    for (at = (at ^ at >>> 15) & table.length - 1; table[at] >= 0 && keys[table[at]] !== key;) at = at + 1 & table.length - 1;
    return at;
  };
  for (let n = 0, last = -1; n < vertices; ++n) {
    const x = lattice[3 * n] * share, y = lattice[3 * n + 1] * share, z = lattice[3 * n + 2] * share;
    const a = Math.round(x), b = Math.round(y), c = Math.round(z), i = Math.floor(x), j = Math.floor(y), k = Math.floor(z);
    const corner = (x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2, middle = (x - i - 0.5) ** 2 + (y - j - 0.5) ** 2 + (z - k - 0.5) ** 2;
    const key = corner <= middle ? 2 * (a + side * (b + side * c)) : 2 * (i + side * (j + side * k)) + 1;
    if (key === last) {  // as of most vertices
      cluster[n] = cluster[n - 1];
      continue;
    }
    last = key;
    let at = find(key);
    if (table[at] < 0) {
      keys[count] = key;
      table[at] = count++;
      if (2 * count >= table.length) {
        const larger = new Int32Array(table.length);
        larger.set(keys);
        [keys, table] = [larger, new Int32Array(2 * table.length).fill(-1)];
        for (let k = 0; k < count; ++k) table[find(keys[k])] = k;
        at = find(key);
      }
    }
    cluster[n] = table[at];
  }
  return {cluster, count};
}

/// A mesh (mesh_data.js) of so many cells: {lattice, vertices, triangles, lines}: places on the mesh's lattice, and indices.
export function standIn({lattice, corners, vertices, bits}, cells) {
  const {cluster, count} = clustersOf(lattice, vertices, 2 ** bits - 1, cells);
  // The middle of the box around a cell's vertices: their mean may be twice as far from one of them.
  const least = new Float32Array(3 * count).fill(Infinity), most = new Float32Array(3 * count);
  for (let n = 0; n < vertices; ++n)
    for (let from = 3 * n, to = 3 * cluster[n], k = 0; k < 3; ++k, ++from, ++to) {
      if (lattice[from] < least[to]) least[to] = lattice[from];
      if (lattice[from] > most[to]) most[to] = lattice[from];
    }
  const places = lattice.constructor.from(least, (v, n) => Math.round((v + most[n]) / 2));
  const triangles = new Rows(3), lines = new Rows(2), edges = new Rows(2);
  for (let n = 0; n < corners.length; n += 3) {
    let a = cluster[corners[n]], b = cluster[corners[n + 1]], c = cluster[corners[n + 2]];
    if (a === b && b === c) continue;
    if (a === b || b === c || c === a) {
      const other = a === b ? c : b;
      lines.add(Math.min(a, other), Math.max(a, other));
      continue;
    }
    if (a > b) [a, b] = [b, a];
    if (b > c) [b, c] = [c, b];
    if (a > b) [a, b] = [b, a];
    triangles.add(a, b, c);
  }
  for (let n = 0, {rows} = triangles; n < 3 * triangles.count; n += 3) {
    edges.add(rows[n], rows[n + 1]);
    edges.add(rows[n + 1], rows[n + 2]);
    edges.add(rows[n], rows[n + 2]);
  }
  const alone = [];
  for (let n = 0; n < 2 * lines.count; n += 2)
    if (!edges.has(lines.rows[n], lines.rows[n + 1])) alone.push(lines.rows[n], lines.rows[n + 1]);
  return {lattice: places, vertices: count, triangles: triangles.all, lines: Uint32Array.from(alone)};
}

/// The same of the fewer triangles that a mesh brings along, with normals as normalsOf() makes them. Their vertices get a list
/// of their own: among all they would be far apart in memory.
export function partOf({lattice, proxyCorners}) {
  const number = new Map(), triangles = proxyCorners.map(v => {
    if (!number.has(v)) number.set(v, number.size);
    return number.get(v);
  });
  const places = new lattice.constructor(3 * number.size);
  for (const [v, n] of number) places.set(lattice.subarray(3 * v, 3 * v + 3), 3 * n);
  const normals = normalsOf({lattice: places, corners: triangles, vertices: number.size});
  return {lattice: places, normals, vertices: number.size, triangles, lines: new Uint32Array(0)};
}
