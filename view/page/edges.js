// SPDX-License-Identifier: Apache-2.0
// Edges of a mesh, to draw.

const kSharp = 0.84;  // cosine of the angle between faces from which on an edge is sharp

/// Pairs of vertices, each edge once: all, or those where the surface bends sharply or ends.
export function edgesOf({lattice, corners, vertices}, sharp) {
  // Edges by their lower vertex: the few of one vertex are compared with each other.
  const start = new Uint32Array(vertices + 1);
  const each = visit => {
    for (let n = 0; n < corners.length; ++n) {
      const a = corners[n], b = corners[n % 3 === 2 ? n - 2 : n + 1];
      if (a !== b) visit(Math.min(a, b), Math.max(a, b), n - n % 3);
    }
  };
  each(low => { ++start[low + 1]; });
  for (let v = 0; v < vertices; ++v) start[v + 1] += start[v];
  const filled = start.slice(), other = new Uint32Array(start[vertices]), face = new Uint32Array(start[vertices]);
  each((low, high, triangle) => {
    other[filled[low]] = high;
    face[filled[low]++] = triangle;
  });
  const out = new Uint32Array(2 * other.length);
  let count = 0;
  for (let v = 0; v < vertices; ++v)
    for (let n = start[v]; n < start[v + 1]; ++n) {
      let faces = 0, before = false, last = n;
      for (let m = start[v]; m < start[v + 1]; ++m)
        if (other[m] === other[n]) {
          ++faces;
          if (m < n) before = true;
          last = m;
        }
      if (before || sharp && faces === 2 && Math.abs(cosine(lattice, corners, face[n], face[last])) > kSharp) continue;
      out[count++] = v;
      out[count++] = other[n];
    }
  return out.slice(0, count);
}

function normal(lattice, corners, at) {
  const [a, b, c] = [0, 1, 2].map(k => lattice.subarray(3 * corners[at + k], 3 * corners[at + k] + 3));
  const u = [b[0] - a[0], b[1] - a[1], b[2] - a[2]], v = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
}
function cosine(lattice, corners, one, two) {
  const a = normal(lattice, corners, one), b = normal(lattice, corners, two);
  return (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / (Math.hypot(...a) * Math.hypot(...b) || 1);
}
