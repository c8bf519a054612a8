// SPDX-License-Identifier: Apache-2.0
// Frames of a flight: as they are streamed, or recorded (fly/flight.h). A frame is {step, rate,
// microseconds, bodies}; a body {at, distance, heading, collisions, crossings}, world units.
import {fromVarints, fromZigzag} from './blob.js';

const kHead = 24, kBody = 28;

/// Cuts a stream of bytes into frames.
export class FrameReader {
  constructor() { this.rest = new Uint8Array(0); }

  /// The frames that these bytes complete.
  take(bytes) {
    const all = new Uint8Array(this.rest.length + bytes.length);
    all.set(this.rest);
    all.set(bytes, this.rest.length);
    const view = new DataView(all.buffer), frames = [];
    let at = 0;
    while (at + kHead <= all.length) {
      const size = view.getUint32(at, true), count = view.getUint32(at + 4, true);
      if (size !== kHead + kBody * count) throw new Error('the flight cannot be read');
      if (at + size > all.length) break;
      const bodies = [];
      for (let n = 0, p = at + kHead; n < count; ++n, p += kBody) {
        const number = k => view.getFloat32(p + 4 * k, true);
        bodies.push({at: [number(0), number(1), number(2)], distance: number(3), heading: number(4),
          collisions: view.getUint32(p + 20, true), crossings: view.getUint32(p + 24, true)});
      }
      frames.push({step: view.getFloat64(at + 8, true), rate: view.getFloat32(at + 16, true),
        microseconds: view.getFloat32(at + 20, true), bodies});
      at += size;
    }
    this.rest = all.slice(at);
    return frames;
  }
}

/// A recorded flight.
export class Recording {
  constructor({header, section}) {
    const {frames, bodies, step, origin} = header, changes = (name, count) => {
      const numbers = fromVarints(section(name), count), out = new Int32Array(count);
      for (let n = 0; n < count; ++n) out[n] = fromZigzag(numbers[n]);
      return out;
    };
    Object.assign(this, {frames, bodies, step, origin});
    this.places = changes('positions', 3 * bodies * frames);
    for (let n = 0; n < this.places.length; n += frames) straighten(this.places.subarray(n, n + frames));
    const summed = (name, rows) => {
      const out = changes(name, rows * frames);
      for (let n = 0; n < out.length; ++n) if (n % frames) out[n] += out[n - 1];
      return out;
    };
    [this.distances, this.collisions, this.crossings] = ['distances', 'collisions', 'crossings'].map(name => summed(name, bodies));
    this.steps = summed('steps', 1);
    const bytes = section('headings');
    this.headings = new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  }

  frame(n) {
    const bodies = [];
    for (let b = 0; b < this.bodies; ++b) {
      const k = b * this.frames + n;
      bodies.push({at: [0, 1, 2].map(axis => this.origin[axis] + this.step * this.places[(3 * b + axis) * this.frames + n]),
        distance: this.step * this.distances[k], heading: this.headings[b], collisions: this.collisions[k], crossings: this.crossings[k]});
    }
    return {step: this.steps[n], bodies};
  }
}

// What was left of each number after a straight continuation becomes the number.
function straighten(row) {
  for (let n = 1; n < row.length; ++n) row[n] += n === 1 ? row[0] : 2 * row[n - 1] - row[n - 2];
}
