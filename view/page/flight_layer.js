// SPDX-License-Identifier: Apache-2.0
// Draws flying bodies with the field around them, and the paths that they took.
import {makeArray, makeBuffer, makeProgram} from './gl.js';
import {normalsOf} from './normals.js';
import {kLightShader} from './shaders.js';

// A contact is of no colour that means a distance.
const kContact = 'vec3(0.88, 0.0, 0.69)';

// How near a wall is, as a colour: 0 touching, 1 far.
const kNearShader = `
vec3 near_color(float t) {
  vec3 hot = vec3(0.93, 0.20, 0.22), warm = vec3(0.98, 0.66, 0.18), cool = vec3(0.20, 0.72, 0.66), cold = vec3(0.28, 0.45, 0.90);
  float u = clamp(t, 0.0, 1.0) * 3.0;
  return u < 1.0 ? mix(hot, warm, u) : u < 2.0 ? mix(warm, cool, u - 1.0) : mix(cool, cold, u - 2.0);
}`;
/// The same colours for a legend, from near to far.
export const kNearColors = ['rgb(237 51 56)', 'rgb(250 168 46)', 'rgb(51 184 168)', 'rgb(71 115 230)'];

const kBodyVertex = `
layout(location = 0) in vec3 corner;
layout(location = 1) in vec4 normal;
layout(location = 2) in vec4 place;   // scene units, and the heading
layout(location = 3) in vec2 state;   // how near a wall; how much it flashes
uniform mat4 camera;
uniform vec3 meshOrigin;              // from the middle of the body, scene units
uniform float meshStep;
out vec3 at;
out vec4 smoothed;
out vec2 condition;
void main() {
  float c = cos(place.w), s = sin(place.w);
  mat3 turn = mat3(c, 0.0, -s, 0.0, 1.0, 0.0, s, 0.0, c);
  at = turn * (meshOrigin + corner * meshStep) + place.xyz;
  smoothed = vec4(turn * normal.xyz, normal.w);
  condition = state;
  gl_Position = camera * vec4(at, 1.0);
}`;
const kBodyFragment = `${kLightShader}${kNearShader}
in vec3 at;
in vec4 smoothed;
in vec2 condition;
uniform vec3 color;
uniform bool shell;
out vec4 pixel;
void main() {
  vec3 view = view_of(at), flatNormal = normalize(cross(dFdx(at), dFdy(at)));
  if (dot(flatNormal, view) < 0.0) flatNormal = -flatNormal;
  vec3 s = normalize(smoothed.xyz + 1e-9);
  if (dot(s, flatNormal) < 0.0) s = -s;
  vec3 n = normalize(mix(flatNormal, s, smoothstep(0.0, 0.35, smoothed.w)));
  if (shell) {
    float rim = pow(1.0 - abs(dot(n, view)), 2.0), alpha = 0.10 + 0.55 * rim + 0.35 * condition.y;
    pixel = vec4(mix(near_color(condition.x), ${kContact}, condition.y) * alpha, alpha);
  } else {
    pixel = vec4(mix(lit(color, n, view, 1.0), ${kContact}, 0.85 * condition.y), 1.0);
  }
}`;

const kSegmentsPerRow = 256;  // of the texture
// Six corners a segment. Segments lie in a texture: to draw an instance of four corners for each is many times slower where
// there is no graphics card.
const kPathVertex = `
uniform highp sampler2D segments;   // three texels each
uniform mat4 camera;
uniform vec2 pixels;
uniform float width;
out vec3 shade;                     // how near; how faded; across
void main() {
  int segment = gl_VertexID / 6, corner = gl_VertexID % 6;
  ivec2 texel = ivec2(3 * (segment % ${kSegmentsPerRow}), segment / ${kSegmentsPerRow});
  vec4 from = texelFetch(segments, texel, 0), to = texelFetch(segments, texel + ivec2(1, 0), 0);  // scene units, and how near a wall
  vec2 fade = texelFetch(segments, texel + ivec2(2, 0), 0).xy;  // at both ends; below 0: a mark
  vec4 a = camera * vec4(from.xyz, 1.0), b = camera * vec4(to.xyz, 1.0);
  // Behind the eye a segment has no direction on the picture.
  if (a.w < 1e-4 || b.w < 1e-4) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  vec2 along = (b.xy / b.w - a.xy / a.w) * pixels;
  along = length(along) > 1e-3 ? normalize(along) : vec2(1.0, 0.0);
  bool end = corner == 1 || corner > 3;
  float side = corner == 2 || corner == 3 || corner == 5 ? 1.0 : -1.0;
  float wide = fade.x < 0.0 ? 1.6 * width : width;
  vec4 p = end ? b : a;
  // A little longer than it is, so that corners are closed.
  p.xy += (vec2(-along.y, along.x) * side + along * (end ? 0.3 : -0.3)) * wide / pixels * p.w;
  shade = vec3(end ? to.w : from.w, end ? fade.y : fade.x, side);
  gl_Position = p;
}`;
const kPathFragment = `${kNearShader}
in vec3 shade;
uniform vec3 markColor;
out vec4 pixel;
void main() {
  float edge = smoothstep(1.0, 0.55, abs(shade.z));
  if (shade.y < 0.0) { pixel = vec4(markColor * edge, edge); return; }
  float alpha = shade.y * edge;
  pixel = vec4(near_color(shade.x) * alpha, alpha);
}`;

const kManyBodies = 12;  // more than this are drawn with fewer triangles

/// Whole rows of the texture.
export const segmentRoom = count => new Float32Array(12 * kSegmentsPerRow * Math.max(1, Math.ceil(count / kSegmentsPerRow)));

export class FlightLayer {
  /// `fly` and `shell` are meshes (mesh_data.js) around `middle`, world units; `look` is the viewer's.
  constructor(gl, fly, shell, middle, look) {
    Object.assign(this, {gl, middle, look});
    this.bodyProgram = makeProgram(gl, kBodyVertex, kBodyFragment);
    this.pathProgram = makeProgram(gl, kPathVertex, kPathFragment);
    this.instances = gl.createBuffer();
    this.segments = gl.createTexture();
    this.fly = this.shape(fly);
    this.shell = shell && this.shape(shell);
    this.noArray = makeArray(gl, []);
    this.bodyCount = this.segmentCount = 0;
    this.shellShown = this.pathsShown = true;
  }

  instanced(location, size, stride, offset) {
    const {gl} = this;
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(location, 1);
  }

  shape(data) {
    const {gl} = this, type = data.bits === 16 ? gl.UNSIGNED_SHORT : gl.FLOAT;
    const positions = makeBuffer(gl, data.lattice), normals = makeBuffer(gl, normalsOf(data));
    const array = indices => {
      const made = gl.createVertexArray();
      gl.bindVertexArray(made);
      gl.bindBuffer(gl.ARRAY_BUFFER, positions);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribPointer(0, 3, type, false, 0, 0);
      gl.bindBuffer(gl.ARRAY_BUFFER, normals);
      gl.enableVertexAttribArray(1);
      gl.vertexAttribPointer(1, 4, gl.SHORT, true, 0, 0);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
      this.instanced(2, 4, 24, 0);
      this.instanced(3, 2, 24, 16);
      makeBuffer(gl, indices, gl.ELEMENT_ARRAY_BUFFER);
      gl.bindVertexArray(null);
      return {array: made, count: indices.length};
    };
    return {data, whole: array(data.corners), proxy: array(data.proxy ? data.proxyCorners : data.corners)};
  }

  /// `bodies`: six numbers each: x, y, z in scene units, heading, how near a wall (0 to 1), how much it flashes.
  /// `segments`: room for `count` or more, from segmentRoom(); twelve numbers each: both ends (x, y, z, how near), how strong
  /// the colour is at both, below 0 for a mark, and two that are not used.
  set(bodies, segments, count) {
    const {gl} = this;
    this.bodyCount = bodies.length / 6;
    this.segmentCount = count;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    gl.bufferData(gl.ARRAY_BUFFER, bodies, gl.STREAM_DRAW);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.segments);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 3 * kSegmentsPerRow, segments.length / 12 / kSegmentsPerRow, 0, gl.RGBA, gl.FLOAT, segments);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
  }

  draw(frame) {
    const {gl} = this;
    this.drawBodies(frame, this.fly, false);
    gl.enable(gl.BLEND);
    if (this.pathsShown && this.segmentCount) {
      const {clientWidth, clientHeight} = gl.canvas;
      this.pathProgram.use({segments: this.segments, camera: frame.uniforms.camera, pixels: [clientWidth / 2, clientHeight / 2],
        width: 1.7, markColor: this.look.ink});
      gl.bindVertexArray(this.noArray);
      gl.drawArrays(gl.TRIANGLES, 0, 6 * this.segmentCount);
    }
    if (this.shellShown && this.shell) {
      gl.depthMask(false);
      this.drawBodies(frame, this.shell, true);
      gl.depthMask(true);
    }
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
  }

  drawBodies(frame, shape, shell) {
    if (this.bodyCount === 0) return;
    const {gl} = this, {data} = shape, {array, count} = this.bodyCount > kManyBodies ? shape.proxy : shape.whole;
    this.bodyProgram.use({...frame.uniforms, shell, color: this.look.ink,
      meshOrigin: data.origin.map((v, k) => (v - this.middle[k]) * frame.scale), meshStep: data.step * frame.scale});
    gl.bindVertexArray(array);
    gl.drawElementsInstanced(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0, this.bodyCount);
  }
}
