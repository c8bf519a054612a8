// SPDX-License-Identifier: Apache-2.0
// Draws a mesh, for each of its bodies; whole, or fewer triangles while something moves.
import {makeArray, makeBuffer, makeProgram} from './gl.js';
import {normalsOf} from './normals.js';
import {kColorShader, kCutShader, kFieldShader, kLightShader} from './shaders.js';
import {identity} from './vec.js';

const kVertex = `
layout(location = 0) in vec3 corner;
layout(location = 1) in vec4 normal;
uniform mat4 camera, body;
uniform vec3 meshOrigin;
uniform float meshStep;
out vec3 at;
out vec4 smoothed;
invariant gl_Position;  // in all programs, for one draws the depths that another compares with
void main() {
  vec4 p = body * vec4(meshOrigin + corner * meshStep, 1.0);
  at = p.xyz;
  smoothed = vec4(mat3(body) * normal.xyz, normal.w);
  gl_Position = camera * p;
}`;

// Only what a picture needs: a field that is looked up nowhere still takes time, and what may be cut away is shaded even
// where something nearer hides it.
const fragmentOf = ({field, cut}) => `${field ? `#define FIELD\n${kFieldShader}${kColorShader}` : ''}${kLightShader}${cut ? kCutShader : ''}
in vec3 at;
in vec4 smoothed;
uniform vec3 color, backColor;
uniform float opacity;
uniform bool flatShading;
out vec4 pixel;
#ifdef FIELD
uniform bool colored, occluded;
// The field says how open the surroundings are: how far along the normal the distance stays behind the way gone.
float openness(vec3 p, vec3 n) {
  if (!occluded) return 1.0;
  float closed = 0.0, weight = 1.0, h = 0.012;
  for (int k = 0; k < 4; ++k) {
    float d = abs(field_a(p + n * h));
    closed += weight * clamp((min(h, bandA) - d) / h, 0.0, 1.0);
    weight *= 0.62;
    h *= 2.1;
  }
  return clamp(1.0 - 0.62 * closed, 0.12, 1.0);
}
#endif
void main() {
  ${cut ? 'if (cut_away(at)) discard;' : ''}
  vec3 view = view_of(at);
  vec3 flatNormal = normalize(cross(dFdx(at), dFdy(at)));
  if (dot(flatNormal, view) < 0.0) flatNormal = -flatNormal;
  vec3 n = flatNormal;
  float share = flatShading ? 0.0 : smoothstep(0.0, 0.35, smoothed.w);
  vec3 s = normalize(smoothed.xyz + 1e-9);
  bool back = dot(s, flatNormal) < 0.0 && smoothed.w > 0.5;
  if (back) s = -s;
  n = normalize(mix(flatNormal, s, share));
  back = back || !gl_FrontFacing;
  vec3 base = back ? backColor : color;
  float open = 1.0;
#ifdef FIELD
  if (colored) { float v = shown(at); if (v < 1e29) base = color_of(v); }
  open = openness(at, flatNormal);
#endif
  float alpha = opacity < 1.0 ? mix(opacity, min(1.0, opacity + 0.75), pow(1.0 - abs(dot(n, view)), 2.5)) : 1.0;
  pixel = vec4(lit(base, n, view, open) * alpha, alpha);
}`;

// One colour.
const plainFragmentOf = ({cut}) => `${cut ? kCutShader : ''}
in vec3 at;
uniform vec4 plainColor;
out vec4 pixel;
void main() {
  ${cut ? 'if (cut_away(at)) discard;' : ''}
  pixel = vec4(plainColor.rgb * plainColor.a, plainColor.a);
}`;

// Triangles that are drawn at once while the whole mesh is drawn piece by piece: the page answers in between.
const kPiece = 400000;

export class MeshLayer {
  constructor(gl) {
    this.gl = gl;
    this.programs = new Map();  // by the text of their second half
    this.meshes = new Map();
  }

  set(id, data) {
    const {gl} = this;
    const old = this.meshes.get(id);
    if (old) {
      for (const buffer of old.buffers) gl.deleteBuffer(buffer);
      for (const array of old.arrays) gl.deleteVertexArray(array);
      this.meshes.delete(id);
    }
    if (!data) return;
    const positions = makeBuffer(gl, data.lattice);
    const normalNumbers = normalsOf(data.lattice, data.corners, data.vertices), normals = makeBuffer(gl, normalNumbers);
    const type = data.bits === 16 ? gl.UNSIGNED_SHORT : gl.FLOAT;
    const attributes = [[0, positions, 3, type], [1, normals, 4, gl.SHORT, true]];
    gl.bindVertexArray(null);
    const whole = makeBuffer(gl, data.corners, gl.ELEMENT_ARRAY_BUFFER);
    const mesh = {data, attributes, buffers: [positions, normals, whole], whole: makeArray(gl, attributes, whole), arrays: []};
    mesh.proxy = data.proxy ? this.proxyOf(data, normalNumbers, type, mesh.buffers) : mesh.whole;
    mesh.arrays.push(mesh.whole, mesh.proxy);
    this.meshes.set(id, mesh);
  }

  // Fewer triangles have vertices of their own, side by side: among all of them they would be far apart in memory.
  proxyOf(data, normals, type, buffers) {
    const {gl} = this, number = new Map(), corners = data.proxyCorners.map(v => {
      if (!number.has(v)) number.set(v, number.size);
      return number.get(v);
    });
    const lattice = new data.lattice.constructor(3 * number.size), few = new Int16Array(4 * number.size);
    for (const [v, n] of number) {
      lattice.set(data.lattice.subarray(3 * v, 3 * v + 3), 3 * n);
      few.set(normals.subarray(4 * v, 4 * v + 4), 4 * n);
    }
    const made = [makeBuffer(gl, lattice), makeBuffer(gl, few)];
    gl.bindVertexArray(null);
    const indices = makeBuffer(gl, corners, gl.ELEMENT_ARRAY_BUFFER);
    buffers.push(...made, indices);
    return makeArray(gl, [[0, made[0], 3, type], [1, made[1], 4, gl.SHORT, true]], indices);
  }

  program(fragment) {
    if (!this.programs.has(fragment)) this.programs.set(fragment, makeProgram(this.gl, kVertex, fragment));
    return this.programs.get(fragment);
  }

  /// Pieces that the whole mesh is drawn in.
  pieces(id) { return Math.max(1, Math.ceil(this.meshes.get(id).data.triangles / kPiece)); }

  /// Draws piece `piece` of the whole mesh, or the proxy. `bodies`: {matrix (scene units), color, opacity}.
  draw(id, frame, look, bodies, piece = -1) {
    const {gl} = this, mesh = this.meshes.get(id);
    const moving = frame.moving && mesh.data.proxy > 0;
    const first = moving || piece < 0 ? 0 : 3 * kPiece * piece;
    const most = 3 * (moving ? mesh.data.proxy : mesh.data.triangles);
    const count = piece < 0 ? most - first : Math.min(3 * kPiece, most - first);
    if (count <= 0) return;
    gl.bindVertexArray(moving ? mesh.proxy : mesh.whole);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    const occluded = look.occluded && !frame.moving, cut = frame.uniforms.cutSide.some(side => side !== 0);
    for (const body of bodies ?? [{}]) {
      const opacity = body.opacity ?? look.opacity;
      const values = {
        ...frame.uniforms, body: body.matrix ?? identity(), meshOrigin: frame.toScene(mesh.data.origin),
        meshStep: mesh.data.step * frame.scale, color: body.color ?? look.color, backColor: look.backColor,
        opacity, flatShading: look.flat, colored: look.colored, occluded, plainColor: [0, 0, 0, 0],
      };
      if (opacity < 1) {
        // The nearest surface alone, over what is opaque: depth first, then its colour.
        this.program(plainFragmentOf({cut})).use(values);
        gl.colorMask(false, false, false, false);
        gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * first);
        gl.colorMask(true, true, true, true);
        gl.depthFunc(gl.LEQUAL);
        gl.enable(gl.BLEND);
      }
      this.program(fragmentOf({field: look.colored || occluded, cut})).use(values);
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * first);
      gl.disable(gl.BLEND);
      gl.depthFunc(gl.LESS);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.bindVertexArray(null);
  }

  /// Draws lines along triangles' sides: `edges` is a list of pairs of vertices, made once (edges.js).
  drawEdges(id, frame, color, bodies, edges) {
    const {gl} = this, mesh = this.meshes.get(id);
    const lines = this.program(plainFragmentOf({cut: true}));
    if (mesh.edgeList !== edges) {
      mesh.edgeList = edges;
      gl.bindVertexArray(null);
      const buffer = makeBuffer(gl, edges, gl.ELEMENT_ARRAY_BUFFER);
      mesh.buffers.push(buffer);
      mesh.edges = makeArray(gl, mesh.attributes, buffer);
    }
    gl.bindVertexArray(mesh.edges);
    gl.enable(gl.BLEND);
    for (const body of bodies ?? [{}]) {
      lines.use({...frame.uniforms, body: body.matrix ?? identity(), meshOrigin: frame.toScene(mesh.data.origin),
        meshStep: mesh.data.step * frame.scale, plainColor: color});
      gl.drawElements(gl.LINES, edges.length, gl.UNSIGNED_INT, 0);
    }
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
  }
}
