// SPDX-License-Identifier: Apache-2.0
// The panel: what is shown, and how. Every control changes the look and says so.
import {grouped, hexOf, parsedColor, shown} from './colors.js';
import {Section} from './controls.js';
import {colorSection} from './panel_colors.js';

const kAxes = 'xyz', kEachAxis = [...kAxes].map((name, axis) => [axis, name]);
const percent = v => `${Math.round(100 * v)} %`;

/// Fills the panel for what the scene holds. `viewer`: its look, and changed().
export function buildPanel(viewer) {
  const {scene} = viewer, controls = {}, sections = [];
  const add = section => sections.push(section.element);
  const field = scene.field(0);
  if (scene.fields.size > 1) add(compareSection(viewer, controls));
  if (field) {
    add(sliceSection(viewer, controls));
    add(isoSection(viewer, controls, field));
    add(colorSection(viewer, controls));
  }
  if (scene.meshes.size) add(meshSection(viewer, controls));
  if (field || scene.meshes.size) add(clipSection(viewer, controls));
  add(eyeSection(viewer, controls));
  add(pointSection(viewer, controls));
  const about = new Section('What the page holds', false);
  about.facts([...scene.meshes.values()].flatMap(meshFacts).concat([...scene.fields.values()].flatMap(fieldFacts)));
  add(about);
  viewer.panel.replaceChildren(...viewer.extraSections.map(s => s.element), ...sections);
  controls.sync = () => sync(controls, viewer);
  return controls;
}

// A control that belongs to the one above it, and is there while that is on.
function under(control, on) {
  control.element.classList.add('under');
  control.element.hidden = !on;
  return control;
}

function compareSection({look, scene, changed}, controls) {
  const section = new Section('Compare');
  controls.comparison = section.choice({label: 'Fields', value: look.comparison, changed: v => { look.comparison = v; changed(); },
    options: [['first', 'A'], ['second', 'B'], ['both', 'A | B'], ['all', 'A | B | A−B'], ['difference', 'A−B']]});
  section.facts([...scene.fields.values()].slice(0, 2).map((f, n) => ['AB'[n], f.name]));
  return section;
}

function sliceSection({look, scene, changed}, controls) {
  const section = new Section('Slices');
  controls.slices = look.slices.map((slice, axis) => {
    const toggle = section.toggle({label: `Across ${kAxes[axis]}`, value: slice.shown, key: kAxes[axis], changed: v => {
      slice.shown = v;
      place.element.hidden = !v;
      changed();
    }});
    const place = under(section.slider({label: `${kAxes[axis]} =`, value: slice.at, step: 'any', show: () => shown(scene.sliceWhere(axis)),
      changed: v => { slice.at = v; changed(); }}), slice.shown);
    place.input.setAttribute('aria-label', `position of the slice across ${kAxes[axis]}`);
    return {toggle, place};
  });
  controls.contours = section.toggle({label: 'Contour lines', key: 'l', value: look.contours, changed: v => { look.contours = v; changed(); }});
  return section;
}

// Where the field has a value, and its samples near the surface.
function isoSection({look, changed}, controls, field) {
  const section = new Section('Isosurface and samples'), [least, greatest] = field.range;
  controls.iso = section.toggle({label: 'Isosurface', key: 'i', value: look.iso.shown, changed: v => {
    look.iso.shown = v;
    for (const control of controls.ofIso) control.element.hidden = !v;
    changed();
  }});
  controls.isoValue = under(section.slider({label: 'at', value: look.iso.value, least, greatest, step: 'any', changed: v => { look.iso.value = v; changed(); },
    show: v => shown(v, 3) + (v >= field.borderLeast && !field.clamped ? ', cut off by the grid' : '')}), look.iso.shown);
  controls.isoValue.input.setAttribute('aria-label', 'value of the isosurface');
  controls.isoOpacity = under(section.slider({label: 'opacity', value: look.iso.opacity, least: 0.05, show: percent,
    changed: v => { look.iso.opacity = v; changed(); }}), look.iso.shown);
  controls.isoOpacity.input.setAttribute('aria-label', 'opacity of the isosurface');
  controls.ofIso = [controls.isoValue, controls.isoOpacity];
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

function meshSection({look, scene, changed}, controls) {
  const section = new Section(scene.meshes.size > 1 ? 'Meshes' : 'Mesh'), {mesh} = look;
  controls.mesh = section.toggle({label: 'Show', key: 'm', value: mesh.shown, changed: v => { mesh.shown = v; changed(); }});
  const own = id => look.meshes[id] ??= {};
  controls.meshes = new Map([...scene.meshes].map(([id, {name}]) => [id, section.item({
    label: name, color: hexOf(scene.colorOf(id)), value: !look.meshes[id]?.hidden,
    colored: v => { own(id).color = parsedColor(v).slice(0, 3); changed(); }, changed: v => { own(id).hidden = !v; changed(); }})]));
  controls.opacity = section.slider({label: 'Opacity', least: 0.05, value: mesh.opacity, show: percent, changed: v => { mesh.opacity = v; changed(); }});
  controls.shading = section.choice({label: 'Shading', value: mesh.flat ? 'flat' : 'smooth', options: [['smooth', 'Smooth'], ['flat', 'Flat']],
    changed: v => { mesh.flat = v === 'flat'; changed(); }});
  controls.edges = section.choice({label: 'Edges', value: mesh.edges, options: [['none', 'None'], ['sharp', 'Sharp'], ['all', 'All']],
    changed: v => { mesh.edges = v; changed(); }});
  if (!scene.fields.size) return section;
  controls.cut = section.toggle({label: 'Cut at slices', key: 'k', value: mesh.cut, changed: v => { mesh.cut = v; changed(); }});
  controls.colored = section.toggle({label: 'Colour by field', value: mesh.colored, changed: v => { mesh.colored = v; changed(); }});
  controls.occluded = section.toggle({label: 'Shade hollows', value: mesh.occluded, changed: v => { mesh.occluded = v; changed(); }});
  return section;
}

// A plane that cuts all but slices.
function clipSection({look, scene, changed}, controls) {
  const section = new Section('Clip', look.clip.shown), {clip} = look;
  controls.clip = section.toggle({label: 'Clip', key: 'c', value: clip.shown, changed: v => { clip.shown = v; changed(); }});
  controls.clipAxis = section.choice({label: 'Across', value: clip.axis, options: kEachAxis, changed: v => {
    clip.axis = v;
    controls.clipAt.set(clip.at);
    changed();
  }});
  controls.clipAt = section.slider({label: 'At', value: clip.at, step: 'any', show: () => shown(scene.clipWhere), changed: v => { clip.at = v; changed(); }});
  controls.clipAt.input.setAttribute('aria-label', 'position of the clip plane');
  controls.flipped = section.toggle({label: 'Other side', value: clip.flipped, changed: v => { clip.flipped = v; changed(); }});
  return section;
}

function eyeSection(viewer, controls) {
  const section = new Section('Eye', false), {camera} = viewer;
  controls.up = section.choice({label: 'Points up', value: camera.up, options: kEachAxis, changed: axis => viewer.standUp(axis)});
  controls.parallel = section.toggle({label: 'Parallel', key: 'o', value: camera.parallel, changed: v => { camera.parallel = v; viewer.changed(); }});
  return section;
}

function pointSection(viewer, controls) {
  const section = new Section('Point');
  controls.measure = section.toggle({label: 'Distance of two points', key: 'd', value: viewer.measures, changed: v => viewer.measure(v)});
  controls.point = section.facts();
  section.element.setAttribute('aria-live', 'polite');
  controls.showPoint = rows => controls.point.set(rows);
  controls.showPoint(viewer.pinned ? viewer.factsOf(viewer.pinned) : [['', 'Click the picture to read a value.']]);
  return section;
}

// Shows what keys, handles and links changed.
function sync(controls, {look, camera, measures}) {
  const set = (name, value) => controls[name]?.set(value);
  controls.slices?.forEach(({toggle, place}, axis) => {
    toggle.set(look.slices[axis].shown);
    place.set(look.slices[axis].at);
    place.element.hidden = !look.slices[axis].shown;
  });
  set('iso', look.iso.shown);
  set('points', look.points.shown);
  for (const [control, on] of [[controls.isoValue, look.iso.shown], [controls.isoOpacity, look.iso.shown], [controls.band, look.points.shown]])
    if (control) control.element.hidden = !on;
  set('contours', look.contours);
  set('mesh', look.mesh.shown);
  set('cut', look.mesh.cut);
  set('edges', look.mesh.edges);
  set('shading', look.mesh.flat ? 'flat' : 'smooth');
  set('clip', look.clip.shown);
  set('up', camera.up);
  set('parallel', camera.parallel);
  set('measure', measures);
}

function meshFacts(mesh) {
  return [['mesh', mesh.name], ['triangles', grouped(mesh.triangles) + (mesh.simplified ? ` of ${grouped(mesh.given)}` : '')],
    ['corners', `within ${shown(mesh.step / 2, 2)}`]];
}

function fieldFacts(field) {
  const rows = [['field', field.name], ['samples', field.given.map(grouped).join(' × ')]];
  if (field.every > 1) rows.push(['in the page', `every ${ordinal(field.every)} per axis`]);
  rows.push(['spacing', [...new Set(field.spacing.map(v => shown(v / field.every)))].join(' × ')]);
  rows.push(['thickness', field.thickness === null ? 'infinite' : shown(field.thickness)]);
  rows.push(['values', [field.min ?? field.range[0], field.max ?? field.range[1]].map(v => shown(v)).join(' to ')]);
  rows.push(['rounded to', shown(field.step, 2)]);
  if (field.sign) rows.push(['sign', field.sign]);
  if (field.method) rows.push(['made by', `${field.method}, standoff ${field.version}`]);
  return rows;
}

const ordinal = n => n === 2 ? '2nd' : n === 3 ? '3rd' : `${n}th`;
