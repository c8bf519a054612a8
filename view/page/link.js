// SPDX-License-Identifier: Apache-2.0
// What is seen, as the fragment of the page's address: who opens that address sees it.
import {clamp} from './vec.js';

const kMark = '#view=';
const rounded = (key, value) => typeof value === 'number' ? Number(value.toPrecision(7)) : value;

const kCamera = ['up', 'parallel', 'azimuth', 'elevation', 'distance', 'target'];
const kLook = ['slices', 'contours', 'colormap', 'range', 'rangeShare', 'logarithmic', 'comparison', 'clip', 'meshes', 'mesh', 'iso', 'points'];
const only = (object, names) => Object.fromEntries(names.map(name => [name, object?.[name]]));

/// What is seen, as text that a fragment may be.
export function fragmentOf({camera, look}) {
  const state = {
    camera: only(camera, kCamera),
    look: {
      ...only(look, kLook), slices: look.slices.map(({shown, at}) => ({shown, at, touched: true})),
      mesh: without(look.mesh, 'color', 'backColor'), iso: without(look.iso, 'color'),
    },
    theme: document.documentElement.dataset.theme,
  };
  return kMark + encodeURIComponent(JSON.stringify(state, rounded));
}

const without = (object, ...names) => Object.fromEntries(Object.entries(object).filter(([name]) => !names.includes(name)));

/// Shows what a fragment says, if it is one of fragmentOf(). Of what it says only what there is already is taken, and only
/// of the same kind: a link may come from anywhere.
export function showFragment(viewer, fragment) {
  if (!fragment.startsWith(kMark)) return false;
  let state;
  try {
    state = JSON.parse(decodeURIComponent(fragment.slice(kMark.length)));
  } catch {
    return false;
  }
  take(viewer.camera, only(state?.camera, kCamera));
  take(viewer.look, only(state?.look, kLook));
  viewer.camera.distance = clamp(viewer.camera.distance, 1e-3, 60);
  viewer.camera.target.forEach((at, axis) => { viewer.camera.target[axis] = clamp(at, -60, 60); });
  if (['light', 'dark'].includes(state?.theme)) document.documentElement.dataset.theme = state.theme;
  viewer.readTheme();
  viewer.rebuild();
  return true;
}

const isColor = v => Array.isArray(v) && v.length === 3 && v.every(Number.isFinite);
const isRange = v => Array.isArray(v) && v.length === 2 && v.every(Number.isFinite) && v[0] < v[1];
const kChoices = {
  up: [0, 1, 2], axis: [0, 1, 2], colormap: ['auto', 'viridis', 'diverging', 'thesis'], edges: ['none', 'sharp', 'all'],
  comparison: ['first', 'second', 'both', 'all', 'difference'],
};

function take(own, said) {
  if (typeof said !== 'object' || said === null) return;
  for (const key of Object.keys(own)) {  // of an array its indices, and not its length
    const value = Object.hasOwn(said, key) ? said[key] : undefined;
    if (value === undefined) continue;
    if (key === 'meshes') own.meshes = meshesOf(value);
    else if (key === 'range') own.range = isRange(value) ? value : null;
    else if (key in kChoices) own[key] = kChoices[key].includes(value) ? value : own[key];
    else if (typeof own[key] === 'object' && own[key] !== null) take(own[key], value);
    else if (typeof own[key] === typeof value && (typeof value !== 'number' || Number.isFinite(value))) own[key] = value;
  }
}

const meshesOf = said => Object.fromEntries(Object.entries(said ?? {}).map(
  ([id, one]) => [id, {hidden: one?.hidden === true, ...(isColor(one?.color) ? {color: one.color} : {})}]));
