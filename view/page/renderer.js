// SPDX-License-Identifier: Apache-2.0
// When and how finely the picture is drawn: quickly while something moves, and of fewer pixels where that takes long, which
// the browser enlarges; at rest the whole, smoothed over several passes that are offset by parts of a pixel.
import {makeArray, makeProgram} from './gl.js';

const kRest = 160;            // milliseconds without a change after which the picture is at rest
const kQuick = 50, kIdle = 14;  // a moving frame that takes longer is drawn more coarsely, a shorter one more finely
const kCoarsest = 0.4, kFirst = 0.5;  // the first picture is soon there, before anyone knows how fast it is drawn
const kFrames = 6;            // moving frames at the coarsest, or at the finest, after which fewer triangles are drawn, or more
const kPasses = 10;
const kSmoothing = 2500;      // milliseconds that smoothing may take

const kCover = 'out vec2 uv; void main() { uv = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0; gl_Position = vec4(uv * 2.0 - 1.0, 0.0, 1.0); }';
const kCopy = 'in vec2 uv; uniform sampler2D picture; uniform float share; out vec4 pixel; void main() { pixel = texture(picture, uv) * share; }';

export class Renderer {
  /// `drawViews(size, jitter, pass)` draws all views into the bound framebuffer; `pieces()` says in how many pieces the
  /// whole is drawn; `afterFrame()` places what lies over the picture; `resize(more)` makes what is drawn while something
  /// moves of more triangles, or of fewer.
  constructor(gl, drawViews, pieces, afterFrame, resize) {
    Object.assign(this, {gl, drawViews, pieces, afterFrame, resize});
    this.smooths = Boolean(gl.getExtension('EXT_color_buffer_float'));
    this.copy = makeProgram(gl, kCover, kCopy);
    this.cover = makeArray(gl, []);
    this.coarse = kFirst;
    this.most = kPasses;
    this.changed = 0;
    this.held = false;    // whether the fine picture has to wait, because something new comes soon
    this.gripped = false;  // the same while a button or finger is down: a fine picture would make what moves wait
    this.complete = false; // whether all that the page holds is there
    this.state = 'idle';  // 'moving', 'waiting', 'resting', 'idle'
    this.frames = [];
    this.slow = this.idle = 0;  // moving frames in a row that took too long though coarse, or left time though fine
    this.waiting = [];
    this.tick = this.tick.bind(this);
    addEventListener('pointerdown', () => { this.gripped = true; }, {capture: true});
    for (const end of ['pointerup', 'pointercancel', 'blur']) addEventListener(end, () => { this.gripped = false; }, {capture: true});
  }

  /// Something changed: draw again.
  request() {
    this.changed = performance.now();
    if (this.state === 'idle') requestAnimationFrame(this.tick);
    this.state = 'moving';
    this.fresh = true;
  }

  /// Once the picture is whole and nothing is left to do.
  settled() {
    return this.state === 'idle' ? Promise.resolve() : new Promise(done => this.waiting.push(done));
  }

  tick() {
    if (this.fence && this.gl.clientWaitSync(this.fence, this.gl.SYNC_FLUSH_COMMANDS_BIT, 0) === this.gl.TIMEOUT_EXPIRED)
      return requestAnimationFrame(this.tick);
    const now = performance.now();
    if (this.fence) this.measured(now);
    if (this.fresh) {
      this.fresh = false;
      this.moving(now);
    } else if (this.state === 'moving' && now - this.changed > kRest && !this.held && !this.gripped) {
      this.state = 'resting';
      if (this.slow >= kFrames || this.idle >= kFrames) this.resize(this.idle >= kFrames);
      this.slow = this.idle = 0;
      this.pass = this.piece = 0;
      this.passes = this.smooths ? this.most : 1;
      this.resting(now);
    } else if (this.state === 'resting') {
      this.resting(now);
    }
    if (this.state !== 'idle') return requestAnimationFrame(this.tick);
    for (const done of this.waiting.splice(0)) done();
  }

  measured(now) {
    this.gl.deleteSync(this.fence);
    this.fence = null;
    const took = now - this.began;
    if (this.kind === 'moving' && this.shown) {
      this.frames.push(took);
      if (this.frames.length > 30) this.frames.shift();
      this.slow = took > kQuick && this.coarse === kCoarsest ? this.slow + 1 : 0;
      this.idle = took < kIdle && this.coarse === 1 ? this.idle + 1 : 0;
      if (took > kQuick) this.coarse = Math.max(kCoarsest, this.coarse * 0.8);
      else if (took < kIdle) this.coarse = Math.min(1, this.coarse * 1.1);
    } else {
      this.passTook += took;
    }
    if (!this.whole || this.shown) return;
    performance.mark('first picture');
    this.shown = true;  // before, programs were made: that says nothing of frames to come
  }

  begin(now, kind) {
    this.began = now;
    this.kind = kind;
    this.whole = this.complete;
  }
  end() {
    this.fence = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.gl.flush();
  }

  size(share) {
    const {clientWidth, clientHeight} = this.gl.canvas, ratio = share * Math.min(devicePixelRatio || 1, 2);
    return [clientWidth, clientHeight].map(v => Math.max(1, Math.round(v * ratio)));
  }

  moving(now) {
    const {gl} = this, size = this.size(this.coarse);
    this.begin(now, 'moving');
    const target = this.target('quick', size, gl.RGBA8);
    this.clear(target);
    this.drawViews(size, [0, 0], {moving: true, piece: 0, last: true});
    this.present(target, 1);
    this.afterFrame();
    this.end();
  }

  // One piece of one pass of the picture at rest.
  resting(now) {
    const {gl} = this, size = this.size(1);
    this.begin(now, 'resting');
    const target = this.target('quick', size, gl.RGBA8), pieces = this.pieces();
    if (this.piece === 0) {
      if (this.pass === 1) this.passes = Math.min(this.passes, Math.ceil(kSmoothing / Math.max(1, this.passTook)));
      if (this.pass >= this.passes) return this.state = 'idle';
      this.passTook = 0;
      this.clear(target);
    } else {
      gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
    }
    // Halton's points: any number of them is spread evenly.
    const jitter = this.pass === 0 ? [0, 0] : size.map((v, k) => (2 * halton(this.pass, 2 + k) - 1) / v);
    this.drawViews(size, jitter, {moving: false, piece: this.piece, last: this.piece === pieces - 1});
    if (++this.piece < pieces) return this.end();
    this.piece = 0;
    if (this.smooths) {
      const sum = this.target('sum', size, gl.RGBA16F);
      gl.bindFramebuffer(gl.FRAMEBUFFER, sum.framebuffer);
      gl.viewport(0, 0, ...size);
      gl.disable(gl.DEPTH_TEST);
      if (this.pass > 0) {
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.ONE, gl.ONE);
      }
      this.cast(target, 1);
      gl.disable(gl.BLEND);
      this.present(sum, 1 / (this.pass + 1));
    } else {
      this.present(target, 1);
    }
    this.afterFrame();
    this.end();
    ++this.pass;
  }

  /// What is on the screen once more: a browser forgets it when it has been shown.
  showAgain() {
    if (this.smooths && this.sum) this.present(this.sum, 1 / this.pass);
    else this.present(this.quick, 1);
  }

  clear(target) {
    const {gl} = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
    gl.viewport(0, 0, ...target.size);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  present(target, share) {
    const {gl} = this, {canvas} = gl, [width, height] = target.size;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = target.size;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    gl.disable(gl.DEPTH_TEST);
    gl.disable(gl.SCISSOR_TEST);
    this.cast(target, share);
  }
  cast(target, share) {
    this.gl.bindVertexArray(this.cover);
    this.copy.use({picture: target.texture, share});
    this.gl.drawArrays(this.gl.TRIANGLES, 0, 3);
    this.gl.bindVertexArray(null);
  }

  target(name, size, format) {
    const {gl} = this, old = this[name];
    if (old && old.size[0] === size[0] && old.size[1] === size[1]) return old;
    if (old) {
      gl.deleteTexture(old.texture);
      gl.deleteFramebuffer(old.framebuffer);
      gl.deleteRenderbuffer(old.depth);
    }
    const texture = gl.createTexture(), framebuffer = gl.createFramebuffer(), depth = gl.createRenderbuffer();
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, ...size);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, ...size);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
    return this[name] = {texture, framebuffer, depth, size};
  }
}

function halton(n, base) {
  let value = 0;
  for (let share = 1 / base; n > 0; n = Math.floor(n / base), share /= base) value += share * (n % base);
  return value;
}
