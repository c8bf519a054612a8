// SPDX-License-Identifier: Apache-2.0
// Draws a mesh, for each of its bodies; whole, or fewer triangles while something moves.
import {makeArray, makeBuffer, makeProgram} from './gl.js';
import {normalsOf} from './normals.js';
import {kColorShader, kCutShader, kFieldShader, kLightShader} from './shaders.js';
import {kCells, partOf, standIn} from './stand_in.js';
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
// The field says how open the surroundings are: how far along the normal the distance stays behind the way gone. Nearer
// than its spacing it says little, and of things thinner than that nothing true.
float openness(vec3 p, vec3 n, float shaded) {
  if (!occluded || shaded == 0.0) return 1.0;
  float spacing = max(spacingA.x, max(spacingA.y, spacingA.z));
  float closed = 0.0, weight = 1.0, h = max(0.02, 2.0 * spacing);
  for (int k = 0; k < 4; ++k) {
    float d = abs(field_a(p + n * h));
    closed += weight * clamp((min(h, bandA) - d - 0.8 * spacing) / h, 0.0, 1.0);
    weight *= 0.62;
    h *= 1.9;
  }
  return 1.0 - shaded * min(0.7 * closed, 0.62);
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
  // Towards a silhouette, behind which the depth jumps, a pixel sees little of a surface, and slivers of its other side:
  // nothing is told of both.
  float facing = smoothstep(0.12, 0.45, mix(dot(flatNormal, view), abs(dot(s, view)), smoothstep(0.0, 0.35, smoothed.w)));
  vec3 base = back ? mix(color, backColor, facing) : color;
  float open = 1.0;
#ifdef FIELD
  if (colored) { float v = shown(at); if (v < 1e29) base = color_of(v); }
  open = openness(at, flatNormal, facing);
#endif
  float alpha = opacity < 1.0 ? mix(opacity, min(1.0, opacity + 0.75), pow(1.0 - abs(dot(n, view)), 2.5)) : 1.0;
  pixel = vec4(lit(base, n, view, open) * alpha, alpha);
}`;

// Of a stand-in made of cells: each triangle is about as small as a pixel, and what normals would add is not seen.
const quickFragmentOf = ({cut}) => `${kLightShader}${cut ? kCutShader : ''}
in vec3 at;
uniform vec3 color;
out vec4 pixel;
void main() {
  ${cut ? 'if (cut_away(at)) discard;' : ''}
  vec3 n = normalize(cross(dFdx(at), dFdy(at)));
  float lamp = dot(n, view_of(at)) < 0.0 ? -dot(n, keyLight) : dot(n, keyLight);
  pixel = vec4(color * (0.45 + 0.64 * max(lamp, 0.0)), 1.0);
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
// A mesh of no more triangles than this is always drawn whole.
const kFew = 70000;
const kFewest = 20000;    // of a stand-in: with less nothing would be told apart
const kBegin = 96;        // cells along the longest side: none is larger than some pixels
const kLineLight = 0.72;  // of lines that stand in for beams: as bright as those are
const kHollow = 0.75;     // of a stand-in whose hollows will be shaded: about as bright as it will be

export class MeshLayer {
  constructor(gl) {
    this.gl = gl;
    this.programs = new Map();  // by the text of their second half
    this.meshes = new Map();
    gl.vertexAttrib4f(1, 0, 0, 0, 0);  // without normals surfaces are flat
    this.budget = 150000;  // triangles and lines of a stand-in
  }

  set(id, data) {
    const {gl} = this;
    const old = this.meshes.get(id);
    if (old) {
      for (const buffer of [...old.buffers, ...old.standIn?.buffers ?? []]) gl.deleteBuffer(buffer);
      for (const array of [...old.arrays, ...old.standIn?.arrays ?? []]) gl.deleteVertexArray(array);
      this.meshes.delete(id);
    }
    if (!data) return;
    const mesh = {data, cells: kCells.indexOf(kBegin), buffers: [], arrays: []};
    this.meshes.set(id, mesh);
    if (data.triangles <= kFew && !data.proxy) return;
    this.build(mesh);
    if (data.proxy) return;
    while (mesh.cells > 0 && mesh.size > 1.5 * this.budget) {
      --mesh.cells;
      this.build(mesh);
    }
  }

  // What draws the whole mesh, made when that is first drawn: a stand-in is soon there.
  whole(mesh) {
    const {gl} = this, {data} = mesh;
    if (mesh.whole) return mesh.whole;
    gl.bindVertexArray(null);
    mesh.buffers = [makeBuffer(gl, data.lattice), makeBuffer(gl, normalsOf(data)), makeBuffer(gl, data.corners, gl.ELEMENT_ARRAY_BUFFER)];
    mesh.attributes = this.attributes(data, ...mesh.buffers);
    mesh.arrays.push(mesh.whole = makeArray(gl, mesh.attributes, mesh.buffers[2]));
    return mesh.whole;
  }
  attributes({bits}, places, normals) {
    const {gl} = this, there = [[0, places, 3, bits === 16 ? gl.UNSIGNED_SHORT : gl.FLOAT]];
    return normals ? [...there, [1, normals, 4, gl.SHORT, true]] : there;
  }

  // The stand-in of a mesh, anew.
  build(mesh) {
    const {gl} = this, {data} = mesh, made = data.proxy ? partOf(data) : standIn(data, kCells[mesh.cells]);
    for (const buffer of mesh.standIn?.buffers ?? []) gl.deleteBuffer(buffer);
    for (const array of mesh.standIn?.arrays ?? []) gl.deleteVertexArray(array);
    gl.bindVertexArray(null);
    const buffers = [made.lattice, ...made.normals ? [made.normals] : []].map(numbers => makeBuffer(gl, numbers));
    const attributes = this.attributes(data, ...buffers);
    const indices = [made.triangles, made.lines].map(list => makeBuffer(gl, list, gl.ELEMENT_ARRAY_BUFFER));
    const arrays = indices.map(list => makeArray(gl, attributes, list));
    mesh.standIn = {made, arrays, buffers: [...buffers, ...indices], triangles: made.triangles.length / 3, lines: made.lines.length / 2};
    mesh.size = mesh.standIn.triangles + mesh.standIn.lines;
  }

  /// Frames take too long, or leave time: stand-ins of another size are made, one step finer or coarser.
  resize(longer) {
    this.budget = longer ? 1.7 * this.budget : Math.max(kFewest, this.budget / 1.7);
    for (const mesh of this.meshes.values()) {
      if (!mesh.standIn || mesh.data.proxy || mesh.data.triangles <= this.budget) continue;
      // A step multiplies the triangles by about 2.
      const wanted = longer ? Number(mesh.size * 2 < this.budget) : -Number(mesh.size > this.budget);
      const cells = Math.min(Math.max(mesh.cells + wanted, 0), kCells.length - 1);
      if (cells === mesh.cells) continue;
      mesh.cells = cells;
      this.build(mesh);
    }
  }

  program(fragment) {
    if (!this.programs.has(fragment)) this.programs.set(fragment, makeProgram(this.gl, kVertex, fragment));
    return this.programs.get(fragment);
  }

  /// Pieces that the whole mesh is drawn in.
  pieces(id) { return Math.max(1, Math.ceil(this.meshes.get(id).data.triangles / kPiece)); }

  /// Whether fewer triangles are drawn while something moves.
  thins(id) {
    const {standIn, data} = this.meshes.get(id);
    return Boolean(standIn) && (data.triangles > this.budget || data.triangles <= kFew);
  }

  /// Draws piece `piece` of the whole mesh, or what stands in for it. `bodies`: {matrix (scene units), color, opacity}.
  draw(id, frame, look, bodies, piece = -1) {
    const {gl} = this, mesh = this.meshes.get(id), few = frame.moving && this.thins(id) ? mesh.standIn : null;
    const first = few || piece < 0 ? 0 : 3 * kPiece * piece, most = 3 * (few ?? mesh.data).triangles;
    const count = piece < 0 ? most - first : Math.min(3 * kPiece, most - first);
    if (count <= 0 && !few) return;
    gl.bindVertexArray(few ? few.arrays[0] : this.whole(mesh));
    gl.enable(gl.POLYGON_OFFSET_FILL);
    // Room for edges over it. Towards a silhouette the slope grows without bound, and what is behind would come forward.
    gl.polygonOffset(look.edges === 'none' ? 0 : 1, 1);
    const occluded = look.occluded && !frame.moving, cut = frame.cuts;
    for (const body of bodies ?? [{}]) {
      const opacity = body.opacity ?? look.opacity, light = few && look.occluded ? kHollow : 1;
      const color = (body.color ?? look.color).map(v => light * v);
      const values = {
        ...frame.uniforms, body: body.matrix ?? identity(), meshOrigin: frame.toScene(mesh.data.origin),
        meshStep: mesh.data.step * frame.scale, color, backColor: few ? color : look.backColor,
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
      const quick = few && !mesh.data.proxy && opacity === 1 && !look.colored;
      this.program(quick ? quickFragmentOf({cut}) : fragmentOf({field: look.colored || occluded, cut})).use(values);
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * first);
      gl.depthFunc(gl.LESS);
      if (few?.lines) {
        gl.bindVertexArray(few.arrays[1]);
        this.program(plainFragmentOf({cut})).use({...values, plainColor: [...color.map(v => kLineLight * v), opacity]});
        gl.drawElements(gl.LINES, 2 * few.lines, gl.UNSIGNED_INT, 0);
        gl.bindVertexArray(few.arrays[0]);
      }
      gl.disable(gl.BLEND);
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
      this.whole(mesh);
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
