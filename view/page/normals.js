// SPDX-License-Identifier: Apache-2.0
// Normals of vertices, for smooth shading.

// Where faces meet at a larger angle than acos of this, the edge is to be seen: those vertices have no normal, and
// triangles fade from smooth to flat towards them.
const kCrease = 0.6;

/// Four numbers of 16 bits a vertex: the normal, weighted by angles nowhere (areas suffice for pictures), and whether
/// it stands for all faces around (1) or not (0).
export function normalsOf({lattice, corners, vertices}) {
  const sum = new Float32Array(3 * vertices), faces = new Float32Array(corners.length);
  for (let n = 0; n < corners.length; n += 3) {
    const a = 3 * corners[n], b = 3 * corners[n + 1], c = 3 * corners[n + 2];
    const ux = lattice[b] - lattice[a], uy = lattice[b + 1] - lattice[a + 1], uz = lattice[b + 2] - lattice[a + 2];
    const vx = lattice[c] - lattice[a], vy = lattice[c + 1] - lattice[a + 1], vz = lattice[c + 2] - lattice[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    faces[n] = x; faces[n + 1] = y; faces[n + 2] = z;
    sum[a] += x; sum[a + 1] += y; sum[a + 2] += z;
    sum[b] += x; sum[b + 1] += y; sum[b + 2] += z;
    sum[c] += x; sum[c + 1] += y; sum[c + 2] += z;
  }
  const out = new Int16Array(4 * vertices).fill(32767);
  for (let n = 0; n < vertices; ++n) {
    const l = 32767 / (Math.hypot(sum[3 * n], sum[3 * n + 1], sum[3 * n + 2]) || 1);
    for (let k = 0; k < 3; ++k) out[4 * n + k] = sum[3 * n + k] * l;
  }
  for (let n = 0; n < corners.length; n += 3) {
    const x = faces[n], y = faces[n + 1], z = faces[n + 2], most = kCrease * 32767 * Math.hypot(x, y, z);
    if (most === 0) continue;
    for (let k = 0; k < 3; ++k) {
      const v = 4 * corners[n + k];
      if (x * out[v] + y * out[v + 1] + z * out[v + 2] < most) out[v + 3] = 0;
    }
  }
  return out;
}
