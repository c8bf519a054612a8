// SPDX-License-Identifier: Apache-2.0
// The panel: what is shown, and how. Every control changes the look and says so.
import {grouped, shown} from './colors.js';
import {Section} from './controls.js';

const kAxes = 'xyz';

/// Fills the panel for what the scene holds. `viewer`: its look, and changed().
export function buildPanel(viewer) {
  const {look, scene} = viewer, changed = () => viewer.changed();
  const controls = {};
  const sections = [];
  const add = section => sections.push(section.element);
  const field = scene.field(0);

  if (scene.fields.size > 1) {
    const compare = new Section('Compare');
    controls.comparison = compare.choice({label: 'Fields', value: look.comparison, changed: v => { look.comparison = v; changed(); },
      options: [['first', 'A'], ['second', 'B'], ['both', 'A | B'], ['all', 'A | B | A−B'], ['difference', 'A−B']]});
    compare.facts([...scene.fields.values()].slice(0, 2).map((f, n) => ['AB'[n], f.name]));
    add(compare);
  }
  if (field) {
    const slices = new Section('Slices');
    controls.slices = look.slices.map((slice, axis) => {
      const toggle = slices.toggle({label: `Across ${kAxes[axis]}`, value: slice.shown, key: kAxes[axis], changed: v => {
        slice.shown = v;
        place.element.hidden = !v;
        changed();
      }});
      const place = slices.slider({label: `${kAxes[axis]} =`, value: slice.at, step: 'any', show: () => shown(scene.sliceWhere(axis)),
        changed: v => { slice.at = v; changed(); }});
      place.input.setAttribute('aria-label', `position of the slice across ${kAxes[axis]}`);
      place.element.classList.add('under');
      place.element.hidden = !slice.shown;
      return {toggle, place};
    });
    controls.contours = slices.toggle({label: 'Contour lines', key: 'l', value: look.contours, changed: v => { look.contours = v; changed(); }});
    add(slices);
    add(isoSection(viewer, controls, field));
    const colors = new Section('Colours');
    controls.colormap = colors.choice({label: 'Map', value: look.colormap, changed: v => { look.colormap = v; changed(); },
      options: [['auto', 'Auto'], ['viridis', 'Viridis'], ['diverging', 'Diverging'], ['thesis', 'Thesis']]});
    controls.range = colors.slider({label: 'Range', least: 0.02, value: look.rangeShare, show: v => `${Math.round(100 * v)} %`,
      changed: v => { look.rangeShare = v; changed(); }});
    add(colors);
  }
  if (scene.meshes.size) {
    const mesh = new Section('Mesh');
    controls.mesh = mesh.toggle({label: 'Show', key: 'm', value: look.mesh.shown, changed: v => { look.mesh.shown = v; changed(); }});
    controls.opacity = mesh.slider({label: 'Opacity', least: 0.05, value: look.mesh.opacity, show: v => `${Math.round(100 * v)} %`,
      changed: v => { look.mesh.opacity = v; changed(); }});
    controls.shading = mesh.choice({label: 'Shading', value: look.mesh.flat ? 'flat' : 'smooth', options: [['smooth', 'Smooth'], ['flat', 'Flat']],
      changed: v => { look.mesh.flat = v === 'flat'; changed(); }});
    controls.edges = mesh.choice({label: 'Edges', value: look.mesh.edges, options: [['none', 'None'], ['sharp', 'Sharp'], ['all', 'All']],
      changed: v => { look.mesh.edges = v; changed(); }});
    if (field) {
      controls.cut = mesh.toggle({label: 'Cut at slices', key: 'k', value: look.mesh.cut, changed: v => { look.mesh.cut = v; changed(); }});
      controls.colored = mesh.toggle({label: 'Colour by field', value: look.mesh.colored, changed: v => { look.mesh.colored = v; changed(); }});
      controls.occluded = mesh.toggle({label: 'Shade hollows', value: look.mesh.occluded, changed: v => { look.mesh.occluded = v; changed(); }});
    }
    add(mesh);
  }
  const eye = new Section('Eye');
  controls.up = eye.choice({label: 'Points up', value: viewer.camera.up, options: [...kAxes].map((name, axis) => [axis, name]),
    changed: axis => viewer.standUp(axis)});
  controls.parallel = eye.toggle({label: 'Parallel', key: 'o', value: viewer.camera.parallel,
    changed: v => { viewer.camera.parallel = v; changed(); }});
  add(eye);
  const point = new Section('Point');
  controls.point = point.facts();
  point.element.setAttribute('aria-live', 'polite');
  controls.pointSection = point;
  controls.showPoint = rows => controls.point.set(rows);
  controls.showPoint(viewer.pinned ? viewer.factsOf(viewer.pinned) : [['', 'Click the picture to read a value.']]);
  add(point);

  const about = new Section('What the page holds', false);
  about.facts([...scene.meshes.values()].flatMap(meshFacts).concat([...scene.fields.values()].flatMap(fieldFacts)));
  add(about);
  viewer.panel.replaceChildren(...viewer.extraSections.map(s => s.element), ...sections);
  controls.sync = () => sync(controls, viewer);
  return controls;
}

// Where the field has a value, and its samples near the surface.
function isoSection(viewer, controls, field) {
  const {look} = viewer, changed = () => viewer.changed();
  const section = new Section('Isosurface and samples'), [least, greatest] = field.range;
  const under = (control, on) => {
    control.element.classList.add('under');
    control.element.hidden = !on;
    return control;
  };
  controls.iso = section.toggle({label: 'Isosurface', key: 'i', value: look.iso.shown, changed: v => {
    look.iso.shown = v;
    controls.isoValue.element.hidden = !v;
    changed();
  }});
  controls.isoValue = under(section.slider({label: 'at', value: look.iso.value, least, greatest, step: 'any', show: v => shown(v, 3),
    changed: v => { look.iso.value = v; changed(); }}), look.iso.shown);
  controls.isoValue.input.setAttribute('aria-label', 'value of the isosurface');
  controls.points = section.toggle({label: 'Samples', key: 'p', value: look.points.shown, changed: v => {
    look.points.shown = v;
    controls.band.element.hidden = !v;
    changed();
  }});
  controls.band = under(section.slider({label: 'within', value: look.points.band, least: 0, greatest: Math.max(-least, greatest), step: 'any',
    show: v => shown(v, 3), changed: v => { look.points.band = v; changed(); }}), look.points.shown);
  controls.band.input.setAttribute('aria-label', 'how far from the surface samples are shown');
  return section;
}

// Shows what keys and handles changed.
function sync(controls, {look, camera}) {
  controls.slices?.forEach(({toggle, place}, axis) => {
    toggle.set(look.slices[axis].shown);
    place.set(look.slices[axis].at);
    place.element.hidden = !look.slices[axis].shown;
  });
  for (const [toggle, slider, on] of [[controls.iso, controls.isoValue, look.iso.shown], [controls.points, controls.band, look.points.shown]]) {
    toggle?.set(on);
    if (slider) slider.element.hidden = !on;
  }
  controls.up.set(camera.up);
  controls.parallel.set(camera.parallel);
  controls.contours?.set(look.contours);
  controls.mesh?.set(look.mesh.shown);
  controls.cut?.set(look.mesh.cut);
  controls.edges?.set(look.mesh.edges);
  controls.shading?.set(look.mesh.flat ? 'flat' : 'smooth');
}

function meshFacts(mesh) {
  const rows = [['mesh', mesh.name], ['triangles', grouped(mesh.triangles) + (mesh.simplified ? ` of ${grouped(mesh.given)}` : '')]];
  if (mesh.proxy) rows.push(['while moving', grouped(mesh.proxy)]);
  rows.push(['corners', `within ${shown(mesh.step / 2, 2)}`]);
  return rows;
}

function fieldFacts(field) {
  const rows = [['field', field.name], ['samples', field.given.map(grouped).join(' × ')]];
  if (field.every > 1) rows.push(['in the page', `every ${ordinal(field.every)} per axis`]);
  rows.push(['spacing', [...new Set(field.spacing.map(v => shown(v / field.every)))].join(' × ')]);
  rows.push(['thickness', field.thickness === null ? 'infinite' : shown(field.thickness)]);
  rows.push(['values', `${shown(field.min)} to ${shown(field.max)}`]);
  rows.push(['rounded to', shown(field.step, 2)]);
  if (field.sign) rows.push(['sign', field.sign]);
  if (field.method) rows.push(['made by', `${field.method}, standoff ${field.version}`]);
  return rows;
}

const ordinal = n => n === 2 ? '2nd' : n === 3 ? '3rd' : `${n}th`;
