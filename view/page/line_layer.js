// SPDX-License-Identifier: Apache-2.0
// Draws lines in the scene: the grid's box, marks, paths.
import {makeArray, makeBuffer, makeProgram} from './gl.js';

const kVertex = `
layout(location = 0) in vec3 corner;
layout(location = 1) in vec4 color;
uniform mat4 camera;
out vec4 shade;
void main() {
  shade = color;
  gl_Position = camera * vec4(corner, 1.0);
}`;
const kFragment = `
in vec4 shade;
out vec4 pixel;
void main() { pixel = vec4(shade.rgb * shade.a, shade.a); }`;

export class LineLayer {
  constructor(gl) {
    this.gl = gl;
    this.program = makeProgram(gl, kVertex, kFragment);
    this.lists = new Map();
  }

  /// Lines between pairs of points (scene units), or along all of them (`strip`), with a colour each (r, g, b, a) or one
  /// for all. null takes them away.
  set(id, points, colors, strip = false) {
    const {gl} = this, old = this.lists.get(id);
    if (old) {
      old.buffers.forEach(buffer => gl.deleteBuffer(buffer));
      gl.deleteVertexArray(old.array);
      this.lists.delete(id);
    }
    if (!points || points.length === 0) return;
    const count = points.length / 3, each = new Float32Array(4 * count);
    for (let n = 0; n < each.length; ++n) each[n] = colors[colors.length === 4 ? n % 4 : n];
    const buffers = [makeBuffer(gl, Float32Array.from(points)), makeBuffer(gl, each)];
    this.lists.set(id, {buffers, count, strip,
      array: makeArray(gl, [[0, buffers[0], 3, gl.FLOAT], [1, buffers[1], 4, gl.FLOAT]])});
  }

  draw(frame) {
    const {gl} = this;
    if (this.lists.size === 0) return;
    this.program.use(frame.uniforms);
    gl.enable(gl.BLEND);
    for (const {array, count, strip} of this.lists.values()) {
      gl.bindVertexArray(array);
      gl.drawArrays(strip ? gl.LINE_STRIP : gl.LINES, 0, count);
    }
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
  }
}

/// The twelve edges of a box, as pairs of points.
export function edgesOfBox([least, greatest]) {
  const points = [];
  for (let corner = 0; corner < 8; ++corner)
    for (let axis = 0; axis < 3; ++axis)
      if (!(corner >> axis & 1))
        for (const end of [corner, corner | 1 << axis])
          points.push(...[0, 1, 2].map(k => (end >> k & 1 ? greatest : least)[k]));
  return points;
}
