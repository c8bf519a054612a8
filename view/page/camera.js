// SPDX-License-Identifier: Apache-2.0
// The eye: it looks at a point, from a direction and a distance.
import {add, clamp, cross, dot, normalized, product, scaled, subtract, through} from './vec.js';

const kHalfView = 0.36;  // radians, half of the picture's shorter side
const kSteep = 1.553;    // just below straight up: the picture's up stays defined

export class Camera {
  constructor(up) {
    this.parallel = false;
    this.standUp(up);
  }

  /// Makes an axis, 0 x, 1 y or 2 z, the one that points up, and looks from where one begins to look.
  standUp(up) {
    this.up = up;
    this.azimuth = this.up === 1 ? Math.PI / 2 + 0.55 : 0.65;  // what has y upwards looks along z
    this.elevation = 0.42;
    this.distance = 4;
    this.target = [0, 0, 0];
  }

  /// Unit vectors: to the right, upwards, and towards the eye.
  axes() {
    const e = this.elevation, a = this.azimuth;
    const flat = Math.cos(e), local = [flat * Math.sin(a), -flat * Math.cos(a), Math.sin(e)];
    const u = this.up, back = [0, 0, 0];
    back[(u + 1) % 3] = local[0];
    back[(u + 2) % 3] = local[1];
    back[u] = local[2];
    const upward = [0, 0, 0];
    upward[u] = 1;
    const right = normalized(cross(upward, back));
    return {right, upward: cross(back, right), back};
  }
  eye() { return add(this.target, scaled(this.axes().back, this.distance)); }

  /// The matrix of a picture `aspect` times as wide as high. `radius`: of what there is to see around the origin;
  /// `jitter`: in parts of the picture.
  matrix(aspect, radius, jitter = [0, 0]) {
    const {right, upward, back} = this.axes(), eye = this.eye();
    const view = Float64Array.of(
      right[0], upward[0], back[0], 0, right[1], upward[1], back[1], 0, right[2], upward[2], back[2], 0,
      -dot(right, eye), -dot(upward, eye), -dot(back, eye), 1);
    const reach = radius + Math.hypot(...this.target);
    const far = this.distance + reach, near = Math.max(this.distance - reach, this.distance / 500);
    const [tx, ty] = this.slopes(aspect);
    const lens = this.parallel
      ? Float64Array.of(1 / (tx * this.distance), 0, 0, 0, 0, 1 / (ty * this.distance), 0, 0,
        0, 0, 2 / (near - far), 0, jitter[0], jitter[1], (far + near) / (near - far), 1)
      : Float64Array.of(1 / tx, 0, 0, 0, 0, 1 / ty, 0, 0,
        -jitter[0], -jitter[1], (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0);
    return product(lens, view);
  }

  // Half the picture's width and height at distance 1.
  slopes(aspect) {
    const t = Math.tan(kHalfView);
    return aspect > 1 ? [t * aspect, t] : [t, t / aspect];
  }

  /// How large a unit is on a picture so many pixels high; in perspective, at distance 1.
  pixelsPerUnit(height, aspect) {
    return height / 2 / this.slopes(aspect)[1] / (this.parallel ? this.distance : 1);
  }

  /// From a point of the picture (-1 to 1, upwards): where a ray starts, and its direction.
  ray(x, y, aspect) {
    const {right, upward, back} = this.axes(), [tx, ty] = this.slopes(aspect), eye = this.eye();
    const aside = add(scaled(right, x * tx), scaled(upward, y * ty));
    if (this.parallel) return {from: add(eye, scaled(aside, this.distance)), direction: scaled(back, -1)};
    return {from: eye, direction: normalized(subtract(aside, back))};
  }

  turn(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = clamp(this.elevation + elevation, -kSteep, kSteep);
  }
  /// By parts of the picture's height.
  pan(x, y) {
    const {right, upward} = this.axes(), size = 2 * Math.tan(kHalfView) * this.distance;
    this.target = subtract(this.target, add(scaled(right, x * size), scaled(upward, y * size)));
  }
  /// Nearer (factor below 1) or farther, with the ray through (x, y) kept where it is on the picture.
  zoom(factor, x = 0, y = 0, aspect = 1) {
    const before = this.distance;
    this.distance = clamp(this.distance * factor, 1e-3, 60);
    const {right, upward} = this.axes(), [tx, ty] = this.slopes(aspect), change = before - this.distance;
    this.target = add(this.target, add(scaled(right, x * tx * change), scaled(upward, y * ty * change)));
  }
  /// Looks along an axis: 0 x, 1 y, 2 z; from the positive side, or the negative one.
  along(axis, side) {
    const u = this.up;
    this.elevation = axis === u ? side * kSteep : 0;
    this.azimuth = axis === u ? 0 : axis === (u + 1) % 3 ? side * Math.PI / 2 : side > 0 ? Math.PI : 0;
  }

  /// Far enough for a box to fill a picture, with a margin.
  frame(box, aspect, margin = 1.12) {
    this.target = box[0].map((v, k) => (v + box[1][k]) / 2);
    const {right, upward, back} = this.axes(), [tx, ty] = this.slopes(aspect);
    this.distance = 1e-3;
    for (let corner = 0; corner < 8; ++corner) {
      const p = subtract([0, 1, 2].map(k => box[corner >> k & 1][k]), this.target);
      const aside = Math.max(Math.abs(dot(p, right)) / tx, Math.abs(dot(p, upward)) / ty);
      this.distance = Math.max(this.distance, margin * aside + (this.parallel ? 0 : dot(p, back)));
    }
  }
}

/// Where a point of the scene is on the picture, in pixels from its upper left; null behind the eye.
export function onPicture(matrix, point, width, height) {
  const p = through(matrix, point);
  return p[3] <= 0 ? null : [(p[0] / p[3] + 1) / 2 * width, (1 - p[1] / p[3]) / 2 * height];
}
