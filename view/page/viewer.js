// SPDX-License-Identifier: Apache-2.0
// The viewer: everything that others may ask of the page. Sources of data (embedded.js, a server) and parts that bring
// controls of their own build on its public methods alone; view/README.md lists them.
import {unpacked} from './blob.js';
import {Camera, onPicture} from './camera.js';
import {niceBelow, niceStep, parsedColor, shown} from './colors.js';
import {Section, element} from './controls.js';
import {FieldData} from './field_data.js';
import {Help} from './help.js';
import {Legend} from './legend.js';
import {fragmentOf} from './link.js';
import {MeshData} from './mesh_data.js';
import {buildPanel} from './panel.js';
import {pick} from './pick.js';
import {followPointers} from './pointer.js';
import {Renderer} from './renderer.js';
import {Scene} from './scene.js';
import {SliceHandles} from './slice_handles.js';
import {Toolbar} from './toolbar.js';
import {Triad} from './triad.js';
import {clamp, identity} from './vec.js';
import {viewsOf} from './views.js';

export class Viewer {
  constructor(config, root = document) {
    this.config = config;
    this.stage = root.getElementById('stage');
    this.panel = root.getElementById('panel');
    this.canvas = root.getElementById('picture');
    this.unit = config.unit || 'world units';
    const gl = this.canvas.getContext('webgl2', {antialias: false, alpha: true, depth: false, powerPreference: 'high-performance'});
    if (!gl) throw new Error('This browser does not offer WebGL 2, which draws the picture. Try another browser, or another machine.');
    this.gl = gl;
    this.look = {
      slices: [0, 1, 2].map(() => ({shown: false, at: 0.5, touched: false})), contours: true, comparison: 'all',
      colormap: 'auto', range: null, rangeShare: 1, logarithmic: false,
      mesh: {shown: true, opacity: 1, flat: false, colored: false, cut: true, occluded: true, edges: 'none'},
      meshes: {},  // by id: {hidden, color}, where they are not as all are
      iso: {shown: false, value: 0, opacity: 1}, points: {shown: false, band: 0},
      clip: {shown: false, axis: 0, at: 0.5, flipped: false},
      axisColors: [], beyond: [0.5, 0.5, 0.5],
    };
    this.camera = new Camera('xyz'.indexOf(config.up));
    this.scene = new Scene(gl, config, this.look);
    this.renderer = new Renderer(gl, (...a) => this.drawViews(...a), () => this.pieces(), () => this.afterFrame(),
      more => this.scene.meshLayer.resize(more));
    this.extraSections = [];
    this.extraKeys = [];
    this.measures = false;  // whether the next click ends a distance, or begins one
    this.changed = this.changed.bind(this);
    this.cold = true;  // nothing is there to be drawn
    this.buildOverlays();
    this.readTheme();
    this.renderer.moving(performance.now());
    followPointers(this.canvas, this.camera, {
      changed: () => this.changed(), leave: () => this.hover(null),
      hover: (x, y) => this.hover([x, y]), click: (x, y) => this.readAt(x, y),
      grip: (x, y, e) => this.handles.moverAt(x, y, e)});
    this.canvas.addEventListener('dblclick', e => this.turnAbout(e.offsetX, e.offsetY));
    new ResizeObserver(() => this.changed()).observe(this.canvas);
    this.canvas.addEventListener('webglcontextlost', e => {
      e.preventDefault();
      this.status('The graphics were lost. Load the page again.');
    });
  }

  // ---- What others may call ----

  /// Shows a mesh under an id, in place of the one with that id; `packed` as the program packs it, null takes it away.
  async setMesh(id, packed) { return this.setUnpacked(id, packed && await unpacked(packed), 'mesh'); }
  /// The same for a field. The first two fields in the order of their first appearance are A and B.
  async setField(id, packed) { return this.setUnpacked(id, packed && await unpacked(packed), 'field'); }
  /// What unpacked() gave; its header says what it is.
  setUnpacked(id, blob, kind = blob.header.kind) {
    const first = this.scene.meshes.size + this.scene.fields.size === 0;
    if (kind === 'mesh') this.scene.setMesh(id, blob && new MeshData(blob));
    else this.scene.setField(id, blob && new FieldData(blob));
    if (blob && first) this.firstLook = true;
    this.rebuild();
  }

  /// Several bodies of the mesh `id` in place of the one: [{color: [r, g, b] from 0 to 1, opacity}]; null: the one.
  setBodies(id, bodies) {
    if (bodies) this.scene.bodies.set(id, bodies.map(b => ({...b, matrix: identity()})));
    else this.scene.bodies.delete(id);
    this.changed();
  }
  /// Where the bodies of mesh `id` are: twelve numbers each, the rows of a matrix of three rows and four columns that takes
  /// the mesh's coordinates to the world's.
  setPoses(id, poses) {
    const {center, scale} = this.scene;
    this.scene.bodies.get(id)?.forEach((body, n) => {
      const p = poses.subarray(12 * n, 12 * n + 12), m = body.matrix;
      for (let row = 0; row < 3; ++row) {
        for (let column = 0; column < 3; ++column) m[4 * column + row] = p[4 * row + column];
        const moved = p[4 * row] * center[0] + p[4 * row + 1] * center[1] + p[4 * row + 2] * center[2] + p[4 * row + 3];
        m[12 + row] = (moved - center[row]) * scale;
      }
    });
    this.changed();
  }
  /// Lines in world units: x, y, z of each point; `colors`: r, g, b, a for each point or once for all; `strip`: along all
  /// points, else between pairs. null takes them away.
  setLines(id, points, colors = [0.5, 0.5, 0.5, 1], strip = false) {
    const placed = points && new Float32Array(points.length);
    for (let n = 0; points && n < points.length; ++n) placed[n] = (points[n] - this.scene.center[n % 3]) * this.scene.scale;
    this.scene.lineLayer.set(id, placed, colors, strip);
    this.changed();
  }
  /// A part of the panel for others' controls (controls.js); it stays when the rest is built anew.
  addSection(title, open = true) {
    const section = new Section(title, open);
    this.extraSections.push(section);
    this.panel.append(section.element);
    return section;
  }
  /// A key for an action, with the words that help shows.
  addKey(key, words, action) { this.extraKeys.push([[key], words, action]); }
  /// A line over the picture; empty: none. `share`: how much of the work is done, null: nobody knows.
  status(text, share = null) {
    this.statusLine.hidden = !text;
    this.statusLine.firstChild.textContent = text;
    this.statusLine.lastChild.hidden = share === null;
    if (share !== null) this.statusLine.lastChild.value = share;
  }
  /// Asked for the exact distance at a point of the world, if set: a promise of {distance, point, triangle}.
  askExact = null;
  /// Draws the picture again, quickly now and finely once nothing changes.
  changed() { if (!this.cold) this.renderer.request(); }
  /// Resolves when the picture is whole.
  settled() { return this.renderer.settled(); }

  // ---- What the page does itself ----

  buildOverlays() {
    this.legends = [new Legend(this.config), new Legend(this.config)];  // of distances, of differences
    this.panelLegends = element('div', {class: 'legends'}, this.legends[1].element);  // where several pictures share them
    this.triad = new Triad((axis, side) => { this.camera.along(axis, side); this.changed(); });
    this.readout = element('div', {id: 'readout', 'aria-hidden': 'true', hidden: true}, element('b'), element('span'));
    this.marker = element('div', {id: 'marker', hidden: true, 'aria-hidden': 'true'}, element('span'));
    this.labels = element('div', {id: 'labels'});
    this.statusLine = element('div', {id: 'status', role: 'status', hidden: true}, element('span'), element('progress', {max: 1}));
    this.handles = new SliceHandles(this);
    this.help = new Help(this.keys(), this.extraKeys);
    this.toolbar = new Toolbar(this);
    this.stage.append(this.labels, this.handles.element, this.marker, this.triad.element, this.readout,
      this.statusLine, this.toolbar.element);
    document.body.append(this.help.dialog);
  }

  keys() {
    const {look, camera} = this, step = 0.09;
    const act = f => e => { f(e); this.controls.sync(); this.changed(); };
    const move = (x, y) => act(e => e.shiftKey ? camera.pan(-x * 0.04, y * 0.04) : camera.turn(x * step, y * step));
    const slide = side => act(() => {
      for (const slice of look.slices) if (slice.shown) slice.at = clamp(slice.at + side * 0.01, 0, 1);
    });
    return [
      [['ArrowLeft'], '', move(-1, 0)], [['ArrowRight'], '', move(1, 0)], [['ArrowUp'], '', move(0, 1)],
      [['ArrowDown'], '', move(0, -1)], [['←', '→', '↑', '↓'], 'turn; with Shift: move', () => {}],
      [['+', '='], 'nearer', act(() => camera.zoom(0.88))], [['-'], 'farther', act(() => camera.zoom(1 / 0.88))],
      [['0', 'r'], 'all in the picture', act(() => this.frame())],
      [['1', '2', '3'], 'along x, y, z', act(e => camera.along(Number(e.key) - 1, 1))],
      [['u'], 'the next axis points up', act(() => this.standUp((camera.up + 1) % 3))],
      [['o'], 'parallel or perspective', act(() => { camera.parallel = !camera.parallel; })],
      [['x', 'y', 'z'], 'slices', act(e => { const s = look.slices['xyz'.indexOf(e.key)]; s.shown = !s.shown; })],
      [['[', ']'], 'move the slices', e => slide(e.key === '[' ? -1 : 1)(e)],
      [['l'], 'contour lines', act(() => { look.contours = !look.contours; })],
      [['m'], 'mesh', act(() => { look.mesh.shown = !look.mesh.shown; })],
      [['i'], 'isosurface', act(() => { look.iso.shown = !look.iso.shown; })],
      [['p'], 'samples near the surface', act(() => { look.points.shown = !look.points.shown; })],
      [['c'], 'clip', act(() => { look.clip.shown = !look.clip.shown; })],
      [['d'], 'distance of two points', act(() => this.measure(!this.measures))],
      [['k'], 'cut the mesh at slices', act(() => { look.mesh.cut = !look.mesh.cut; })],
      [['f'], 'flat or smooth', act(() => { look.mesh.flat = !look.mesh.flat; })],
      [['Enter'], 'read the value in the middle', () => this.readAt(this.canvas.clientWidth / 2, this.canvas.clientHeight / 2)],
      [['t'], 'dark or light', () => this.toolbar.toggleTheme()],
      [['?'], 'this help', () => this.help.toggle()],
    ];
  }

  /// Colours out of the style sheet: the one place where they are.
  readTheme() {
    const style = getComputedStyle(document.documentElement), color = name => parsedColor(style.getPropertyValue(name));
    this.look.axisColors = ['--x', '--y', '--z'].map(name => color(name).slice(0, 3));
    this.look.beyond = color('--beyond').slice(0, 3);
    this.look.mesh.color = color('--mesh').slice(0, 3);
    this.look.mesh.backColor = color('--mesh-back').slice(0, 3);
    this.look.iso.color = color('--iso').slice(0, 3);
    this.look.edgeColor = color('--edge');
    this.look.ink = color('--ink').slice(0, 3);
    this.outlineColor = color('--outline');
    this.scene.outline(this.outlineColor);
    this.changed();
  }

  rebuild() {
    this.cold = false;
    if (this.firstLook) {
      this.firstLook = false;
      const field = this.scene.field(0);
      queueMicrotask(() => this.frame());
      if (field) this.chooseSlice(field);
    } else if (this.scene.field(0) && !this.look.slices.some(s => s.shown || s.touched)) {
      this.chooseSlice(this.scene.field(0));
    }
    this.scene.outline(this.outlineColor);
    this.controls = buildPanel(this);
    this.canvas.setAttribute('aria-label', `picture of ${[...this.scene.meshes.values(), ...this.scene.fields.values()].map(d => d.name).join(', ')}`);
    this.changed();
  }
  // Begins with the plane that shows the most, as standoff slice does.
  chooseSlice(field) {
    const most = Math.max(...field.range.map(Math.abs));
    const {borderLeast} = field, usual = niceStep(most, 12);
    this.look.iso.value = borderLeast > 0 && usual >= borderLeast ? niceBelow(0.95 * borderLeast) : usual;
    this.look.points.band = Math.min(1.5 * Math.max(...field.spacing), most);
    const slice = this.look.slices[field.plane];
    slice.at = field.plane_at;
    slice.shown = slice.touched = true;
    // To cut a factory at a plane that lies would leave its floor.
    this.look.mesh.cut = field.plane !== this.camera.up;
  }

  /// Makes an axis the one that points up: 0 x, 1 y, 2 z.
  standUp(axis) {
    this.camera.standUp(axis);
    this.frame();
  }

  /// Puts what is seen into the page's address, and that on the clipboard where the browser lets it.
  async keepView() {
    history.replaceState(null, '', fragmentOf(this));
    const kept = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    this.status(kept ? 'The link to this view is on the clipboard.' : 'The page\'s address is now the link to this view.');
    setTimeout(() => this.status(''), 3000);
  }

  frame() {
    const {camera, scene} = this;
    camera.frame(scene.subject, this.aspectOf(this.views()[0].rect));
    this.changed();
  }

  get isPhone() { return matchMedia('(max-width: 760px)').matches; }
  views() {
    const {camera, canvas, scene} = this, size = [Math.max(1, canvas.clientWidth), Math.max(1, canvas.clientHeight)];
    return viewsOf(scene, this.look, size, rect =>
      camera.pixelsPerUnit(rect[3] * size[1], this.aspectOf(rect)) * scene.scale / (camera.parallel ? 1 : camera.distance));
  }
  aspectOf(rect) { return this.canvas.clientWidth * rect[2] / Math.max(1, this.canvas.clientHeight * rect[3]); }
  pieces() { return Math.max(1, ...[...this.scene.meshes.keys()].map(id => this.scene.meshLayer.pieces(id))); }

  drawViews(size, jitter, pass) {
    const {gl, scene} = this;
    gl.enable(gl.SCISSOR_TEST);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    for (const view of this.views()) {
      const box = view.rect.map((v, k) => Math.round(v * size[k % 2]));
      gl.viewport(...box);
      gl.scissor(...box);
      const matrix = this.camera.matrix(this.aspectOf(view.rect), scene.radius, jitter.map((v, k) => v / view.rect[2 + k]));
      const pixelsPerUnit = this.camera.pixelsPerUnit(box[3], this.aspectOf(view.rect));
      const seen = {...view, matrix, pixelsPerUnit, camera: this.camera};
      if (this.cold) scene.warm(seen);
      else scene.draw(seen, pass);
    }
    gl.disable(gl.SCISSOR_TEST);
  }

  afterFrame() {
    const views = this.views();
    this.triad.turn(this.camera.axes());
    this.showLegends(views);
    const labels = JSON.stringify(views.map(view => [view.label, view.rect]));
    if (labels !== this.labelled) this.labelViews(views);
    this.labelled = labels;
    this.handles.place(views[0]);
    const at = this.pinned && this.placeOf(this.pinned.scene, views[0]);
    this.marker.hidden = !at;
    if (at) this.marker.style.transform = `translate(${at[0]}px, ${at[1]}px)`;
    this.drawn = (this.drawn ?? 0) + 1;
  }

  // Over one picture; of several in the panel, where they hide nothing.
  showLegends(views) {
    const several = views.length > 1, [first, second] = this.legends, home = several ? this.panelLegends : this.stage;
    if (first.element.parentNode !== home) home.prepend(first.element);
    const shown = [false, true].map(difference => views.findLast(v => v.fields.length > 0 && v.difference === difference));
    if (!several) shown.splice(0, 2, shown[0] ?? shown[1]);
    first.show(shown[0], !several && this.isPhone, several);
    second.show(shown[1], false, several);
    const scaled = views.find(v => v.fields.length > 0);
    if (scaled) this.controls.showScale?.(scaled);
  }

  labelViews(views) {
    this.labels.replaceChildren(...views.filter(v => v.label).map(view => {
      const label = element('span', {}, view.label);
      label.style.left = `${100 * view.rect[0]}%`;
      label.style.top = `${100 * (1 - view.rect[1] - view.rect[3])}%`;
      label.classList.toggle('first', view.rect[1] + view.rect[3] > 0.99);
      return label;
    }));
  }

  /// Where a point of the scene is in a view, in pixels of the canvas.
  placeOf(point, view) {
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight], [x, y, w, h] = view.rect;
    const at = onPicture(this.camera.matrix(this.aspectOf(view.rect), this.scene.radius), point, w * width, h * height);
    return at && [at[0] + x * width, at[1] + (1 - y - h) * height];
  }

  /// The ray through a pixel of the canvas, and the view that it is in.
  rayAt(px, py) {
    const x = px / this.canvas.clientWidth, y = 1 - py / this.canvas.clientHeight;
    const view = this.views().find(({rect: [l, b, w, h]}) => x >= l && x < l + w && y >= b && y <= b + h);
    if (!view) return null;
    const [l, b, w, h] = view.rect;
    return {view, ray: this.camera.ray(2 * (x - l) / w - 1, 2 * (y - b) / h - 1, this.aspectOf(view.rect))};
  }

  /// What is under a pixel of the canvas: pick()'s answer with what the fields say there.
  probe(px, py) {
    const there = this.rayAt(px, py), found = there && pick(this.scene, this.camera, there.ray);
    if (!found) return null;
    const [a, b] = there.view.fields.map(f => f.at(found.point));
    return {...found, field: a ?? null, other: b ?? null, difference: a && b ? a.value - b.value : null};
  }

  hover(at) {
    this.hovered = at;
    if (this.hoverAsked) return;
    this.hoverAsked = true;
    requestAnimationFrame(() => {
      this.hoverAsked = false;
      const found = this.hovered && this.probe(...this.hovered);
      this.readout.hidden = !found;
      if (!found) return;
      const [value, where] = this.readout.children;
      value.textContent = valueOf(found);
      where.textContent = `at (${found.point.map(v => shown(v)).join(', ')})`;
    });
  }

  /// Whether clicks measure distances.
  measure(on) {
    this.measures = on;
    this.began = null;
    this.setLines('measured', null);
  }

  /// Reads the value under a pixel of the canvas, and marks it.
  readAt(px, py) {
    const found = this.pinned = this.probe(px, py);
    this.marker.firstChild.textContent = found ? valueOf(found) : '';
    if (found && this.measures) this.measureTo(found);
    this.controls.showPoint(found ? this.factsOf(found) : [['', 'Nothing is there.']]);
    this.changed();
    if (found && this.askExact) this.addExact(found);
    return found;
  }
  // The first click begins a distance, the second ends it.
  measureTo(found) {
    const from = this.began;
    this.began = from ? null : found;
    this.setLines('measured', from && [...from.point, ...found.point], [...this.look.ink, 1]);
    if (!from) {
      this.marker.firstChild.textContent = 'from here to ..';
      return;
    }
    found.from = from;
    this.marker.firstChild.textContent = shown(lengthBetween(found));
  }

  // What a server computes from the mesh itself follows when it comes.
  async addExact(found) {
    const exact = await this.askExact(found.point).catch(() => null);
    if (!exact || this.pinned !== found) return;
    found.exact = exact;
    if (!this.measures) this.marker.firstChild.textContent = shown(exact.distance, 6);
    this.controls.showPoint(this.factsOf(found));
  }
  factsOf(found) {
    const {field, other, difference, point, kind, name, triangle, exact, from} = found, rows = [];
    if (from) rows.push(['from', `(${from.point.map(v => shown(v, 5)).join(', ')})`], ['length', shown(lengthBetween(found), 6)]);
    if (exact) {
      rows.push(['exact distance', shown(exact.distance, 9)], ['nearest point', `(${exact.point.map(v => shown(v, 6)).join(', ')})`]);
      if (exact.triangle !== null) rows.push(['of triangle', String(exact.triangle)]);
    }
    if (difference !== null) rows.push(['difference', shown(difference)], ['A', valueText(field)], ['B', valueText(other)]);
    else if (field) rows.push([exact ? 'in the field' : 'distance', valueText(field)]);
    rows.push(['at', `(${point.map(v => shown(v, 5)).join(', ')})`]);
    if (field && !field.clamped) rows.push(['gradient', `(${field.gradient.map(v => shown(v, 3)).join(', ')})`]);
    if (field && field.triangle !== null) rows.push(['nearest', `triangle ${field.triangle}`]);
    if (triangle !== null) rows.push(['triangle', String(triangle)]);
    rows.push(['on', kind === 'slice' ? `the slice across ${name}` : name]);
    return rows;
  }

  turnAbout(px, py) {
    const found = this.probe(px, py);
    if (!found) return;
    this.camera.target = found.scene;
    this.changed();
  }
}

const lengthBetween = ({from, point}) => Math.hypot(...point.map((v, k) => v - from.point[k]));
const valueOf = ({difference, field, name}) => difference !== null ? shown(difference) : field ? valueText(field) : name;
const valueText = at => (at.clamped ? (at.value < 0 ? 'below ' : 'beyond ') : '') + shown(at.value);
