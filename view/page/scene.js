// SPDX-License-Identifier: Apache-2.0
// What there is to see, and how a view of it is drawn.
import {colorsOf, colorTexture, parsedColor} from './colors.js';
import {fieldTextures, textureOf3D} from './field_texture.js';
import {LineLayer, edgesOfBox} from './line_layer.js';
import {edgesOf} from './edges.js';
import {MeshLayer} from './mesh_layer.js';
import {PointLayer} from './point_layer.js';
import {SliceLayer} from './slice_layer.js';
import {surfaceOf} from './surface_nets.js';
import {emptyBox, joined, length, middle, normalized, add, scaled} from './vec.js';

const kHuge = 1e29;
// The smallest of meshes.
const kSpeck = {lattice: new Uint16Array(9), corners: Uint32Array.of(0, 1, 2), vertices: 3, triangles: 1, bits: 16, origin: [0, 0, 0], step: 1};

export class Scene {
  constructor(gl, config, look) {
    this.gl = gl;
    this.look = look;
    this.meshes = new Map();
    this.fields = new Map();
    this.textures = new Map();
    this.bodies = new Map();  // of a mesh: where it stands, several times perhaps; none: once, as it is
    this.meshLayer = new MeshLayer(gl);
    this.sliceLayer = new SliceLayer(gl);
    this.lineLayer = new LineLayer(gl);
    this.surfaces = new Map();  // of fields: {value, data}, at the last value that was asked for
    this.points = new Map();
    this.edges = new Map();
    this.extras = [];  // layers of others: draw(frame)
    this.bodyColors = config.bodies.map(parsedColor).map(color => color.slice(0, 3));
    this.colors = Object.fromEntries(Object.entries(config.colormaps).map(
      ([name, text]) => [name, colorTexture(gl, colorsOf(text, 256))]));
    this.nothing = textureOf3D(gl, [1, 1, 1], new Uint16Array(1), [gl.R16F, gl.RED, gl.HALF_FLOAT], gl.LINEAR);
    this.noTiles = textureOf3D(gl, [1, 1, 1], new Int32Array(1), [gl.R32I, gl.RED_INTEGER, gl.INT], gl.NEAREST);
    this.place();
  }

  setMesh(id, data) {
    this.meshLayer.set(id, data);
    if (data) this.meshes.set(id, data); else this.meshes.delete(id);
    this.edges.delete(id);
    this.place();
  }

  setField(id, data) {
    const old = this.textures.get(id);
    if (old) for (const texture of [old.texture, old.tiles]) this.gl.deleteTexture(texture);
    this.textures.delete(id);
    this.forget(this.fields.get(id));
    if (data) {
      this.fields.set(id, data);
      this.textures.set(id, fieldTextures(this.gl, data));
    } else {
      this.fields.delete(id);
    }
    this.place();
  }

  forget(field) {
    if (!field) return;
    this.meshLayer.set(field, null);
    this.points.get(field)?.set(null);
    this.surfaces.delete(field);
    this.points.delete(field);
  }

  /// The surface of a field where it has the value that is shown; made anew when that changes.
  surface(field) {
    const {value} = this.look.iso, old = this.surfaces.get(field);
    if (old?.value === value) return old.data;
    const data = surfaceOf(field, value);
    this.surfaces.set(field, {value, data});
    this.meshLayer.set(field, data.triangles ? data : null);
    return data;
  }

  pointsOf(field) {
    if (!this.points.has(field)) this.points.set(field, new PointLayer(this.gl));
    const layer = this.points.get(field);
    layer.set(field, this.look.points.band);
    return layer;
  }

  // Those of the whole mesh: not while fewer triangles are drawn.
  drawEdges(frame) {
    const {edges} = this.look.mesh;
    if (edges === 'none') return;
    for (const [id, mesh] of this.meshes) {
      if (!this.isShown(id) || (frame.moving && this.meshLayer.thins(id))) continue;
      const key = `${id} ${edges}`;
      if (!this.edges.has(id) || this.edges.get(id).key !== key) this.edges.set(id, {key, list: edgesOf(mesh, edges === 'sharp')});
      this.meshLayer.drawEdges(id, frame, this.look.edgeColor, this.bodies.get(id), this.edges.get(id).list);
    }
  }

  // Scene units: whatever the world's, the middle is 0 and the longest side 2, which floats like.
  place() {
    const meshes = [...this.meshes.values()].map(m => m.box), fields = [...this.fields.values()].map(f => f.box);
    this.worldBox = [...meshes, ...fields].reduce(joined, emptyBox());
    if (meshes.length + fields.length === 0) this.worldBox = [[-1, -1, -1], [1, 1, 1]];
    this.center = middle(this.worldBox);
    const side = Math.max(...this.worldBox[0].map((v, k) => this.worldBox[1][k] - v));
    this.scale = side > 0 ? 2 / side : 1;
    const subject = meshes.length ? meshes.reduce(joined, emptyBox()) : this.worldBox;
    this.subject = subject.map(p => this.toScene(p));
    this.box = this.worldBox.map(p => this.toScene(p));
    this.radius = Math.max(0.01, length(this.box[1]));
  }
  toScene(p) { return p.map((v, k) => (v - this.center[k]) * this.scale); }
  toWorld(p) { return p.map((v, k) => v / this.scale + this.center[k]); }

  field(n) { return [...this.fields.values()][n] ?? null; }

  /// The box that slices and the field's outline are in: world units.
  get sliceBox() { return this.field(0)?.box ?? this.worldBox; }

  fieldUniforms(fields) {
    const values = {};
    ['A', 'B'].forEach((letter, n) => {
      const field = fields[n] ?? fields[0], gpu = field && this.textures.get([...this.fields].find(([, f]) => f === field)[0]);
      Object.assign(values, {
        [`field${letter}`]: gpu?.texture ?? this.nothing, [`tiles${letter}`]: gpu?.tiles ?? this.noTiles,
        [`slots${letter}`]: gpu?.slots ?? [0, 0, 0], [`outside${letter}`]: gpu?.outside ?? 0,
        [`origin${letter}`]: field ? this.toScene(field.origin) : [0, 0, 0],
        [`spacing${letter}`]: field ? field.spacing.map(v => v * this.scale) : [1, 1, 1],
        [`size${letter}`]: field?.size ?? [1, 1, 1],
        [`unit${letter}`]: gpu ? gpu.unit * this.scale : 1,
        [`band${letter}`]: field?.clamped ? (field.clamped - 0.5) * field.step * this.scale : kHuge,
      });
    });
    return values;
  }

  // What layers need of one view, and the planes of slices: {frame, planes}.
  frameOf(view, pass) {
    const {look} = this, {camera} = view, {right, upward, back} = camera.axes();
    const cut = [0, 0, 0], cutAt = [0, 0, 0], eye = camera.eye();
    const planes = [];
    look.slices.forEach((slice, axis) => {
      if (!slice.shown || view.fields.length === 0) return;
      const where = this.slicePosition(axis);
      planes.push({axis, where, color: look.axisColors[axis]});
      cut[axis] = look.mesh.cut ? (eye[axis] >= where ? 1 : -1) : 0;
      cutAt[axis] = where;
    });
    const frame = {
      moving: pass.moving, cuts: look.clip.shown || cut.some(side => side !== 0), scale: this.scale, pixelsPerUnit: view.pixelsPerUnit, toScene: p => this.toScene(p), matrix: view.matrix,
      uniforms: {
        camera: view.matrix, eye, parallel: camera.parallel, towardsEye: back,
        keyLight: normalized(add(add(scaled(back, 0.75), scaled(upward, 0.55)), scaled(right, 0.38))),
        ...this.fieldUniforms(view.fields), showing: view.fields.length === 0 ? 0 : view.difference ? 2 : 1,
        colors: this.colors[view.colormap], range: view.range.map(v => v * this.scale), beyond: look.beyond,
        diverging: view.diverging, logarithmic: view.logarithmic, cutSide: cut, cutAt, clip: this.clipPlane(),
      },
    };
    return {frame, planes};
  }

  /// Draws next to nothing with what most pictures need: graphics make their programs ready while data are on their way.
  warm(view) {
    const {frame} = this.frameOf(view, {moving: true}), black = [0, 0, 0];
    this.meshLayer.set('speck', kSpeck);
    this.meshLayer.draw('speck', {...frame, cuts: true}, {...this.look.mesh, color: black});
    this.meshLayer.set('speck', null);
    this.sliceLayer.draw(frame, this.box, [{axis: 0, where: 0, color: black}], {contourStep: 1, zeroLine: false});
  }

  /// Draws one view. `view`: {matrix, camera, fields, difference, range, colormap}; `pass`: {moving, piece}.
  draw(view, pass) {
    const {look} = this, {frame, planes} = this.frameOf(view, pass), solid = look.mesh.opacity >= 1;
    const meshes = () => {
      if (!look.mesh.shown) return;
      for (const id of this.meshes.keys())
        if (this.isShown(id) && pass.piece < this.meshLayer.pieces(id))
          this.meshLayer.draw(id, frame, {...look.mesh, color: this.colorOf(id), occluded: look.mesh.occluded && view.fields.length > 0},
            this.bodies.get(id), pass.piece);
    };
    const isosurface = () => {
      const field = view.fields[0];
      if (field && look.iso.shown && this.surface(field).triangles)
        this.meshLayer.draw(field, frame, {...look.mesh, color: look.iso.color, backColor: look.iso.color, opacity: look.iso.opacity,
          colored: view.difference, occluded: false});
    };
    if (solid) meshes();
    if (pass.last) {
      const field = view.fields[0];
      if (look.iso.opacity >= 1) isosurface();
      if (field && look.points.shown) this.pointsOf(field).draw(frame);
      this.drawEdges(frame);
      if (planes.length)
        this.sliceLayer.draw(frame, this.sliceBox.map(p => this.toScene(p)), planes,
          {contourStep: look.contours ? view.contourStep * this.scale : 0, zeroLine: view.zeroLine});
      for (const extra of this.extras) extra.draw(frame, view);
      this.lineLayer.draw(frame);
      if (look.iso.opacity < 1) isosurface();
    }
    if (!solid) meshes();
  }

  /// Of a mesh: whether it is shown, and in which colour: its own, or one that tells several apart.
  isShown(id) { return this.look.mesh.shown && !this.look.meshes[id]?.hidden; }
  colorOf(id) {
    const own = this.look.meshes[id]?.color, n = [...this.meshes.keys()].indexOf(id);
    return own ?? (this.meshes.size > 1 && n > 0 ? this.bodyColors[(n - 1) % this.bodyColors.length] : this.look.mesh.color);
  }

  /// Where the clip plane is, in world units.
  get clipWhere() {
    const {axis, at} = this.look.clip, [least, greatest] = this.worldBox;
    return least[axis] + (greatest[axis] - least[axis]) * at;
  }
  /// As shaders have it: nothing is away where all four are 0.
  clipPlane() {
    const {shown, axis, flipped} = this.look.clip, plane = [0, 0, 0, 0], side = flipped ? -1 : 1;
    if (!shown) return plane;
    plane[axis] = side;
    plane[3] = side * (this.clipWhere - this.center[axis]) * this.scale;
    return plane;
  }

  /// Where a slice is, in scene units and in the world's.
  slicePosition(axis) { return this.toScene([0, 1, 2].map(() => this.sliceWhere(axis)))[axis]; }
  sliceWhere(axis) {
    const [least, greatest] = this.sliceBox;
    return least[axis] + (greatest[axis] - least[axis]) * this.look.slices[axis].at;
  }

  outline(color) {
    this.lineLayer.set('outline', color && this.fields.size ? edgesOfBox(this.sliceBox.map(p => this.toScene(p))) : null, color);
  }
}
