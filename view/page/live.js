// SPDX-License-Identifier: Apache-2.0
// A page whose server computes: what a slider says is asked for while it moves.
import {unpacked} from './blob.js';
import {shown} from './colors.js';
import {kinds, sources} from './embedded.js';

const kPatience = 250;  // milliseconds that a computation may take before what is newer ends it

async function asked(path, options) {
  const answer = await fetch(path, options);
  if (!answer.ok) throw Object.assign(new Error((await answer.text()).trim()), {status: answer.status});
  return answer;
}
const bytes = async path => (await asked(path)).arrayBuffer();

class LiveField {
  constructor(viewer, state) {
    this.viewer = viewer;
    this.say = {resolution: state.resolution, thickness: state.thickness, sign: state.sign, device: state.device};
    this.section = viewer.addSection('Compute');
    this.buildControls(state);
    this.took = null;
  }

  async showMesh() { await this.viewer.setMesh('live', await bytes('data?id=live')); }

  buildControls(state) {
    const {section, say} = this, change = changes => { Object.assign(this.say, changes); this.compute(); };
    const most = Math.log2(state.most_resolution);
    section.slider({label: 'Resolution', least: 3, greatest: most, step: 0.125, value: Math.log2(say.resolution),
      show: v => String(Math.round(2 ** v)), changed: v => change({resolution: Math.round(2 ** v)})});
    // In parts of the mesh's longest side; the end of the slider is a full field.
    const side = state.longest_side, text = v => v >= 0 ? 'inf' : String(Number((side * 10 ** v).toPrecision(3)));
    const world = Number.parseFloat(say.thickness), fixed = Number.isFinite(world) && !say.thickness.endsWith('s');
    section.slider({label: 'Thickness', least: -3, greatest: 0, step: 0.01, value: fixed && side > 0 ? Math.log10(world / side) : 0,
      show: v => v >= 0 ? 'full field' : shown(side * 10 ** v, 3), changed: v => change({thickness: text(v)})});
    section.choice({label: 'Sign', value: say.sign, options: state.signs.map(s => [s, s]), changed: sign => change({sign})});
    section.choice({label: 'Device', value: say.device, options: state.devices.map(d => [d, d]), changed: device => change({device})});
    this.facts = section.facts();
  }

  /// Asks for the field as the controls are now. While one is computed the newest request waits for it, but not long: then
  /// it is sent, and the server leaves the older one.
  async compute() {
    this.wanted = true;
    if (this.timer) return;
    const late = this.busy ? kPatience - (performance.now() - this.busy) : 0;
    if (late > 0) {
      this.timer = setTimeout(() => { this.timer = null; if (this.wanted) this.send(); }, late);
      return;
    }
    return this.send();
  }

  async send() {
    this.wanted = false;
    // The fine picture would keep busy what the next one needs.
    this.viewer.renderer.held = true;
    const began = this.busy = performance.now(), query = new URLSearchParams(this.say);
    try {
      const answer = await asked(`compute?${query}`, {method: 'POST'});
      const blob = await unpacked(await answer.arrayBuffer());
      await this.meshShown;
      if (this.busy !== began) return;
      this.viewer.setUnpacked('computed', blob);
      this.took = performance.now() - began;
      this.facts.set([['samples', blob.header.size.join(' × ')], ['took', `${Math.round(this.took)} ms`]]);
      this.viewer.status('');
    } catch (error) {
      if (error.status === 409 || this.busy !== began) return;
      this.viewer.status(error.message);
    }
    if (this.busy !== began) return;
    this.busy = null;
    this.viewer.renderer.held = false;
    clearTimeout(this.timer);
    this.timer = null;
    if (this.wanted) await this.send();
  }

  /// Work that takes long shows how far it has come.
  hear({stage, fraction}) {
    if (!this.busy || performance.now() - this.busy < kPatience) return;
    this.viewer.status(`computing: ${stage}`, fraction);
  }

  async drop(file) {
    this.viewer.status(`reading ${file.name}`);
    const answer = await asked(`upload?${new URLSearchParams({name: file.name})}`, {method: 'POST', body: file});
    const state = (await answer.json()).live;
    this.viewer.camera.standUp('xyz'.indexOf(state.up));
    this.viewer.scene.setField('computed', null);
    await this.showMesh();
    this.section.body.replaceChildren();
    this.buildControls(state);
    this.viewer.status('');
    await this.send();
    this.viewer.frame();
  }
}

function takeDrops(viewer, live) {
  const {stage} = viewer;
  for (const name of ['dragenter', 'dragover'])
    stage.addEventListener(name, e => {
      e.preventDefault();
      e.dataTransfer.dropEffect = 'copy';
      stage.classList.add('dropping');
    });
  for (const name of ['dragleave', 'drop']) stage.addEventListener(name, () => stage.classList.remove('dropping'));
  stage.addEventListener('drop', e => {
    e.preventDefault();
    const [file] = e.dataTransfer.files;
    if (file) live.drop(file).catch(error => viewer.status(error.message));
  });
}

sources.server = async viewer => {
  const state = await (await asked('state')).json();
  // Open for as long as the page is: its end tells the server that nobody looks any more.
  const events = new EventSource('events');
  events.onerror = () => viewer.status('standoff was stopped: what is shown stays, and nothing new is computed.');
  events.onopen = () => viewer.status('');
  for (const {id, kind} of state.items) {
    const blob = await unpacked(await bytes(`data?id=${id}`));
    await (kinds[kind] ?? kinds.unknown)(viewer, id, blob);
  }
  if (!state.live) return;
  const live = viewer.live = new LiveField(viewer, state.live);
  viewer.askExact = async point => (await asked(`point?at=${point.join(',')}`)).json();
  events.onmessage = e => live.hear(JSON.parse(e.data));
  live.meshShown = live.showMesh();  // the field is computed while the mesh is on its way
  takeDrops(viewer, live);
  await Promise.all([live.meshShown, live.send()]);
};
