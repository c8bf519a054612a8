// SPDX-License-Identifier: Apache-2.0
// Draws planes through a field, coloured, with contour lines.
import {makeArray, makeProgram} from './gl.js';
import {kColorShader, kFieldShader} from './shaders.js';

const kVertex = `
uniform mat4 camera;
uniform vec3 least, greatest;
uniform int axis;
uniform float where;
uniform bool outline;
out vec3 at;
void main() {
  // Around the plane for its outline, in a Z for its triangles.
  int n = outline ? (gl_VertexID ^ (gl_VertexID >> 1)) : gl_VertexID;
  vec2 q = vec2(n & 1, n >> 1);
  vec3 share = axis == 0 ? vec3(0.0, q) : axis == 1 ? vec3(q.y, 0.0, q.x) : vec3(q, 0.0);
  at = mix(least, greatest, share);
  if (axis == 0) at.x = where; else if (axis == 1) at.y = where; else at.z = where;
  gl_Position = camera * vec4(at, 1.0);
}`;

const kFragment = `${kFieldShader}${kColorShader}
in vec3 at;
uniform float contourStep, zeroAt, opacity;
uniform bool outline, zeroLine;
uniform vec3 outlineColor;
out vec4 pixel;
float line(float steps, float slope, float width) {
  float away = abs(fract(steps - 0.5) - 0.5) / max(slope, 1e-6);
  return 1.0 - smoothstep(width - 0.5, width + 0.5, away);
}
void main() {
  if (outline) { pixel = vec4(outlineColor, 1.0); return; }
  float v = shown(at);
  vec3 color = color_of(v);
  bool known = v < 1e29;
  // Where the known ends within these four pixels, there is no slope, and no line.
  bool whole = fwidth(known ? 0.0 : 1.0) == 0.0;
  float slope = fwidth(known ? v : 0.0);
  if (known && whole && contourStep > 0.0) {
    float dense = slope / contourStep;  // lines nearer than eight pixels are none, they would hide the colours
    float ink = line(v / contourStep, dense, 0.55) * (1.0 - smoothstep(0.083, 0.125, dense));
    float light = dot(color, vec3(0.30, 0.59, 0.11));
    color = mix(color, light > 0.42 ? color * 0.45 : mix(color, vec3(1.0), 0.5), 0.75 * ink);
  }
  if (known && whole && zeroLine && slope > 0.0) {
    float ink = 1.0 - smoothstep(0.9, 1.9, abs(v) / slope);
    color = mix(color, vec3(0.07, 0.08, 0.10), ink);
  }
  pixel = vec4(color * opacity, opacity);
}`;

export class SliceLayer {
  constructor(gl) {
    this.gl = gl;
    this.program = makeProgram(gl, kVertex, kFragment);
    this.array = makeArray(gl, []);
  }

  /// `planes`: {axis, where (scene units), color}; `box`: of the grid, scene units.
  draw(frame, box, planes, look) {
    const {gl} = this;
    gl.bindVertexArray(this.array);
    for (const plane of planes) {
      const values = {...frame.uniforms, least: box[0], greatest: box[1], axis: plane.axis, where: plane.where,
        contourStep: look.contourStep, zeroLine: look.zeroLine, opacity: 1, outlineColor: plane.color};
      gl.enable(gl.POLYGON_OFFSET_FILL);  // or its outline would be dashed
      gl.polygonOffset(2, 8);
      this.program.use({...values, outline: false});
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
      gl.disable(gl.POLYGON_OFFSET_FILL);
      this.program.use({...values, outline: true});
      gl.drawArrays(gl.LINE_LOOP, 0, 4);
    }
    gl.bindVertexArray(null);
  }
}
