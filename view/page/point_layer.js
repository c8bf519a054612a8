// SPDX-License-Identifier: Apache-2.0
// Draws samples of a field near its surface as points.
import {kInfinite, kNoNumber} from './field_data.js';
import {makeArray, makeBuffer, makeProgram} from './gl.js';
import {kColorShader, kCutShader} from './shaders.js';

const kMost = 200000;  // points; of more, every second, third .. is drawn

const kVertex = `${kColorShader}${kCutShader}
layout(location = 0) in vec4 sampleAt;  // and its value, in scene units
uniform mat4 camera;
uniform vec3 origin, spacing;
uniform float pixels;
out vec3 color;
out float round;  // how much of a ball a point is: shades of a few pixels would make moire
void main() {
  vec3 at = origin + sampleAt.xyz * spacing;
  color = color_of(sampleAt.w);
  gl_Position = camera * vec4(at, 1.0);
  gl_PointSize = cut_away(at) ? 0.0 : clamp(pixels / gl_Position.w, 1.5, 24.0);
  round = smoothstep(6.0, 14.0, gl_PointSize);
  if (cut_away(at)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;
const kFragment = `
in vec3 color;
in float round;
out vec4 pixel;
void main() {
  vec2 q = gl_PointCoord * 2.0 - 1.0;
  float r = dot(q, q);
  if (r > 1.0) discard;
  pixel = vec4(color * (1.0 - 0.45 * r * round), 1.0);
}`;

export class PointLayer {
  constructor(gl) {
    this.gl = gl;
    this.program = makeProgram(gl, kVertex, kFragment);
  }

  /// The samples of a field no farther than `band` (world units) from the surface; null: none.
  set(field, band) {
    const {gl} = this;
    if (this.field === field && this.band === band) return;
    Object.assign(this, {field, band});
    if (this.buffer) {
      gl.deleteBuffer(this.buffer);
      gl.deleteVertexArray(this.array);
    }
    this.buffer = this.array = null;
    this.count = this.every = 0;
    if (!field) return;
    const most = band / field.step, found = [], [tx, ty] = field.tileCount;
    let seen = 0;
    const visit = act => field.slots.forEach((slot, tile) => {
      if (slot < 0 || field.least[slot] > most || field.greatest[slot] < -most) return;
      const first = [8 * (tile % tx), 8 * (Math.floor(tile / tx) % ty), 8 * Math.floor(tile / (tx * ty))];
      for (let n = 0; n < 512; ++n) {
        const code = field.codes[512 * slot + n], size = Math.abs(code);
        if (size > most || code === kNoNumber || size === kInfinite || field.clamped && size >= field.clamped) continue;
        const at = [first[0] + (n & 7), first[1] + (n >> 3 & 7), first[2] + (n >> 6)];
        if (at.every((v, k) => v < field.size[k])) act(at, code);
      }
    });
    visit(() => { ++seen; });
    this.total = seen;
    this.every = Math.max(1, Math.ceil(seen / kMost));
    seen = 0;
    visit((at, code) => { if (seen++ % this.every === 0) found.push(...at, code * field.step); });
    this.worldValues = Float32Array.from(found);
    this.count = found.length / 4;
  }

  draw(frame) {
    const {gl, field} = this;
    if (!this.count) return;
    if (!this.buffer || this.scale !== frame.scale) {
      this.scale = frame.scale;
      const scaled = this.worldValues.map((v, n) => n % 4 === 3 ? v * frame.scale : v);
      this.buffer = makeBuffer(gl, scaled);
      this.array = makeArray(gl, [[0, this.buffer, 4, gl.FLOAT]]);
    }
    const spacing = field.spacing.map(v => v * frame.scale);
    // Colours of their own: the band is often a small part of all values.
    const most = this.band * frame.scale, range = frame.uniforms.range[0] < 0 ? [-most, most] : [0, most];
    this.program.use({...frame.uniforms, range, logarithmic: false, origin: frame.toScene(field.origin), spacing,
      // They touch: through gaps the layers behind would show, in another rhythm.
      pixels: 1.6 * Math.min(...spacing) * frame.pixelsPerUnit * this.every ** (1 / 3)});
    gl.bindVertexArray(this.array);
    gl.drawArrays(gl.POINTS, 0, this.count);
    gl.bindVertexArray(null);
  }
}
