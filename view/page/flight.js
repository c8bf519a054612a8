// SPDX-License-Identifier: Apache-2.0
// A flight on the page: bodies, their paths, contacts and crossings; what is streamed while it flies, or was recorded.
import {unpacked} from './blob.js';
import {grouped, shown} from './colors.js';
import {element, svg} from './controls.js';
import {kinds} from './embedded.js';
import {FrameReader, Recording} from './flight_data.js';
import {FlightLayer, kNearColors, segmentRoom} from './flight_layer.js';
import {MeshData} from './mesh_data.js';
import {clamp} from './vec.js';

const kFlash = 0.18;      // seconds that a contact is seen
const kMostPoints = 8000;   // of all paths together
const kLeastPoints = 40;    // of one
const kMostMarks = 400;

/// The path and the condition of one body.
class Body {
  constructor(state) {
    this.points = [];  // [x, y, z, distance], the oldest first
    this.flashed = -Infinity;
    this.last = this.now = state;
  }

  take(state, seconds, most, spacing) {
    if (state.collisions !== this.now.collisions) this.flashed = seconds;
    const crossed = state.crossings !== this.now.crossings;
    this.last = this.now;
    this.now = state;
    const end = this.points.at(-1), turned = state.collisions !== this.last.collisions;
    if (!end || turned || crossed || Math.hypot(...state.at.map((v, k) => v - end[k])) >= spacing)
      this.points.push([...state.at, state.distance]);
    if (this.points.length > most) this.points.splice(0, this.points.length - most);
    return crossed;
  }
}

class FlightView {
  constructor(viewer, header) {
    Object.assign(this, {viewer, header});
    this.bodies = [];
    this.marks = [];
    // Walls to see through; of few triangles, which are flat.
    Object.assign(viewer.look.mesh, {opacity: 0.16, flat: true});
  }

  async prepare(section) {
    const [fly, shell] = await Promise.all(['fly', 'shell'].map(async name => section(name).length ? new MeshData(await unpacked(section(name))) : null));
    this.layer = new FlightLayer(this.viewer.gl, fly, shell, this.header.middle, this.viewer.look);
    this.viewer.scene.extras.push(this.layer);
    this.section = this.viewer.addSection('Flight');
    this.facts = this.section.facts();
    this.buildLegend();
    this.section.toggle({label: 'Fields around the flies', value: true, changed: v => { this.layer.shellShown = v; this.viewer.changed(); }});
    this.section.toggle({label: 'Paths', value: true, changed: v => { this.layer.pathsShown = v; this.viewer.changed(); }});
    this.viewer.rebuild();
  }

  buildLegend() {
    const bar = element('span', {class: 'near-bar', 'aria-hidden': 'true'});
    bar.style.background = `linear-gradient(to right, ${kNearColors.join(', ')})`;
    this.section.row(element('span', {class: 'label'}, 'Distance to the wall'),
      element('span', {class: 'near'}, '0', bar, shown(this.header.far)));
  }

  forget() {
    this.bodies = [];
    this.marks = [];
  }

  /// A frame has come; `seconds` is when it is to be shown.
  take(frame, seconds) {
    const most = Math.max(kLeastPoints, Math.floor(kMostPoints / frame.bodies.length));
    this.bodies.length = Math.min(this.bodies.length, frame.bodies.length);
    frame.bodies.forEach((state, n) => {
      this.bodies[n] ??= new Body(state);
      if (this.bodies[n].take(state, seconds, most, this.header.spacing)) {
        this.marks.push(this.bodies[n].last.at.map((v, k) => (v + state.at[k]) / 2));
        if (this.marks.length > kMostMarks) this.marks.shift();
      }
    });
  }

  /// Draws the bodies a share of the way from the last frame to this one.
  show(seconds, share = 1) {
    const {center, scale} = this.viewer.scene, {far, length} = this.header, near = d => clamp(d / far, 0, 1);
    const numbers = new Float32Array(6 * this.bodies.length);
    const count = this.bodies.reduce((sum, body) => sum + body.points.length, 3 * this.marks.length);
    const segments = segmentRoom(count);
    let end = 0;
    const put = (out, at, p, w) => {
      for (let k = 0; k < 3; ++k) out[at + k] = (p[k] - center[k]) * scale;
      out[at + 3] = w;
    };
    const segment = (a, nearA, b, nearB, strongA, strongB) => {
      put(segments, end, a, nearA);
      put(segments, end + 4, b, nearB);
      segments[end + 8] = strongA;
      segments[end + 9] = strongB;
      end += 12;
    };
    this.bodies.forEach(({points, last, now, flashed}, n) => {
      const at = now.at.map((v, k) => last.at[k] + (v - last.at[k]) * share);
      put(numbers, 6 * n, at, now.heading);
      numbers[6 * n + 4] = near(now.distance);
      numbers[6 * n + 5] = clamp(1 - (seconds - flashed) / kFlash, 0, 1);
      const strength = k => 0.15 + 0.8 * (k + 1) / (points.length + 1);
      for (let k = 0; k < points.length; ++k) {
        const to = points[k + 1] ?? [...at, now.distance];
        segment(points[k], near(points[k][3]), to, near(to[3]), strength(k), strength(k + 1));
      }
    });
    for (const mark of this.marks)
      for (let axis = 0; axis < 3; ++axis) {
        const ends = [-1, 1].map(side => mark.map((v, k) => v + (k === axis ? side * 0.3 * length : 0)));
        segment(ends[0], 0, ends[1], 0, -1, -1);
      }
    this.layer.set(numbers, segments, count);
    this.viewer.changed();
  }

  tell(frame, more = []) {
    const sum = name => frame.bodies.reduce((total, body) => total + body[name], 0);
    this.facts.set([['flies', grouped(frame.bodies.length)], ['step', grouped(frame.step)], ...more,
      ['contacts', grouped(sum('collisions'))], ['wall crossings', grouped(sum('crossings'))]]);
  }
}

/// Shows what the server flies, and lets its watcher change that.
async function watchFlight(view, controls) {
  const {viewer, section} = view;
  const ask = async changes => {
    Object.assign(controls, changes);
    const answer = await fetch(`controls?${new URLSearchParams(controls)}`, {method: 'POST'});
    viewer.status(answer.ok ? '' : await answer.text());
  };
  let waiting = null, busy = false;
  // One change at a time; of those that come meanwhile the last counts.
  const change = async changes => {
    waiting = {...waiting, ...changes};
    if (busy) return;
    busy = true;
    while (waiting) {
      const next = waiting;
      waiting = null;
      await ask(next);
    }
    busy = false;
  };
  section.choice({label: 'Mode', value: controls.mode, options: [['sweep', 'Sweep'], ['thesis', 'Thesis']],
    changed: mode => { view.marks = []; change({mode}); }});
  const log = (least, greatest) => ({least: Math.log10(least), greatest: Math.log10(greatest), step: 0.01});
  section.slider({label: 'Speed', ...log(0.005, 10), value: Math.log10(controls.speed), show: v => `${shown(10 ** v, 2)} a step`,
    changed: v => change({speed: Number((10 ** v).toPrecision(2))})});
  section.slider({label: 'Steps a second', ...log(1, 20000), value: Math.log10(controls.rate), show: v => shown(Math.round(10 ** v), 2),
    changed: v => change({rate: Math.round(10 ** v)})});
  section.slider({label: 'Flies', ...log(1, 300), value: Math.log10(controls.flies), show: v => String(Math.round(10 ** v)),
    changed: v => change({flies: Math.round(10 ** v)})});

  const answer = await fetch('poses');
  if (!answer.ok) throw new Error(await answer.text());
  const reader = new FrameReader(), stream = answer.body.getReader();
  let arrived = 0, latest = null, told = 0;
  const draw = () => {
    const now = performance.now() / 1000;
    if (latest) {
      // Few steps a second are shown as one movement, not as jumps.
      const lasts = Math.min(1, 1 / Math.max(1e-3, controls.rate));
      view.show(now, lasts > 0.03 ? clamp((now - arrived) / lasts, 0, 1) : 1);
      if (now - told > 0.25) {
        told = now;
        view.tell(latest, [['steps a second', `${grouped(Math.round(latest.rate))} of each`],
          ['one step of all takes', `${shown(latest.microseconds, 3)} µs`]]);
      }
    }
    if (!view.ended) requestAnimationFrame(draw);
  };
  requestAnimationFrame(draw);
  for (;;) {
    const {done, value} = await stream.read();
    if (done) break;
    for (const frame of reader.take(value)) {
      if (!latest || frame.step !== latest.step || frame.bodies.length !== latest.bodies.length) {
        arrived = performance.now() / 1000;
        view.take(frame, arrived);
      }
      latest = frame;
      view.received = (view.received ?? 0) + 1;
    }
  }
  view.ended = true;
  viewer.status('The flight has ended: standoff fly was stopped.');
}

/// Shows a recorded flight again and again.
function replay(view, recording) {
  const {viewer, section, header} = view, last = recording.frames - 1;
  let at = 0, taken = -1, playing = true, speed = 1, before = null;
  const seek = to => {
    if (to < taken || to > taken + 600) {
      view.forget();
      taken = Math.max(-1, to - 600);
    }
    while (taken < to) view.take(recording.frame(++taken), taken / header.frames_per_second);
  };
  const show = () => {
    const whole = Math.min(last, Math.ceil(at));
    seek(whole);
    view.show(at / header.frames_per_second, 1 - (whole - at));
    scrub.set(at);
    view.tell(recording.frame(whole));
  };
  const play = now => {
    const seconds = before === null ? 0 : Math.min(0.1, (now - before) / 1000);
    before = playing ? now : null;
    if (!playing) return;
    at += seconds * speed * header.frames_per_second;
    if (at > last) at = 0;
    show();
    requestAnimationFrame(play);
  };
  const toggle = () => {
    playing = !playing;
    tell();
    if (playing) requestAnimationFrame(play);
  };
  const button = section.button('Pause', toggle);
  // On a phone the panel is closed: play is at hand on the picture too.
  const path = svg('path'), onPicture = element('button', {type: 'button', id: 'play', click: toggle}, svg('svg', {viewBox: '0 0 20 20', 'aria-hidden': 'true'}, path));
  const tell = () => {
    button.set(playing ? 'Pause' : 'Play');
    onPicture.setAttribute('aria-label', playing ? 'pause the flight' : 'play the flight');
    path.setAttribute('d', playing ? 'M6 4h3v12H6zM11 4h3v12h-3z' : 'M6 3.5 16 10 6 16.5z');
  };
  tell();
  viewer.stage.append(onPicture);
  const scrub = section.slider({label: 'Time', least: 0, greatest: Math.max(1, last), value: 0, step: 'any',
    show: v => `${shown(v / header.frames_per_second, 3)} s`, changed: v => { at = Math.min(v, last); show(); }});
  section.slider({label: 'Speed', least: -3, greatest: 3, step: 1, value: 0, show: v => `× ${shown(2 ** v, 3)}`, changed: v => { speed = 2 ** v; }});
  viewer.addKey('p', 'play or pause the flight', () => button.element.click());
  view.player = {seek: to => { at = to; show(); }, pause: () => { if (playing) button.element.click(); }, get at() { return at; }};
  show();
  requestAnimationFrame(play);
}

/// A flight that the page holds, or that its server flies: {kind: 'flight', live, ..}.
kinds.flight = async (viewer, id, {header, section}) => {
  const view = viewer.flight = new FlightView(viewer, header);
  await view.prepare(section);
  if (header.live) watchFlight(view, header.controls).catch(error => viewer.status(error.message));
  else replay(view, new Recording({header, section}));
};
