// SPDX-License-Identifier: Apache-2.0
// What the shaders share. Positions are in scene units: the longest side of what is shown is 2.
import {kScaleShader} from './scale.js';

/// `float field_a(vec3 p)`: the first field's value at a point in scene units, kNothing where none is known; and b.
/// `float shown(vec3 p)`: what the colours show there: the first field, or the difference of both.
export const kFieldShader = `
const float kNothing = 1e30;
uniform sampler3D fieldA, fieldB;
uniform isampler3D tilesA, tilesB;  // the slot of each tile, where only stored ones are there
uniform vec3 slotsA, slotsB;        // per axis; 0: all samples are there
uniform float outsideA, outsideB;   // the value of tiles without a slot
uniform vec3 originA, originB, spacingA, spacingB, sizeA, sizeB;  // scene units; samples
uniform float unitA, unitB, bandA, bandB;                         // scene units; the band ends at the thickness
uniform int showing;                                              // 0: nothing, 1: the first field, 2: the difference
float value_in(sampler3D field, isampler3D tiles, vec3 slots, float outside, vec3 u, vec3 size, float unit) {
  if (any(lessThan(u, vec3(-0.01))) || any(greaterThan(u, size - 0.99))) return kNothing;
  vec3 at = (u + 0.5) / size;
  if (slots.x > 0.0) {
    vec3 inside = clamp(u, vec3(0.0), size - 1.0), tile = floor(min(inside, max(size - 2.0, 0.0)) / 8.0);
    int slot = texelFetch(tiles, ivec3(tile), 0).r;
    if (slot < 0) return (slot == -1 ? outside : -outside) * unit;
    ivec3 n = ivec3(slots);
    vec3 place = vec3(slot % n.x, slot / n.x % n.y, slot / (n.x * n.y));
    at = (place * 9.0 + inside - tile * 8.0 + 0.5) / (slots * 9.0);
  }
  float v = textureLod(field, at, 0.0).r;
  return abs(v) > 128.0 ? kNothing : v * unit;
}
float field_a(vec3 p) { return value_in(fieldA, tilesA, slotsA, outsideA, (p - originA) / spacingA, sizeA, unitA); }
float field_b(vec3 p) { return value_in(fieldB, tilesB, slotsB, outsideB, (p - originB) / spacingB, sizeB, unitB); }
// A value beyond the band is a bound, not a distance: nothing is known of it.
float shown(vec3 p) {
  if (showing == 0) return kNothing;
  float a = field_a(p);
  if (abs(a) >= bandA) return kNothing;
  if (showing == 1) return a;
  float b = field_b(p);
  return abs(b) >= bandB ? kNothing : a - b;
}
`;

export const kColorShader = `${kScaleShader}
uniform sampler2D colors;
uniform vec3 beyond;  // the colour of what is not known
vec3 color_of(float value) {
  if (value >= 1e29) return beyond;
  float t = share_of(value);
  return texture(colors, vec2((t * 255.0 + 0.5) / 256.0, 0.5)).rgb;
}
`;

export const kLightShader = `
uniform vec3 eye, keyLight;
uniform bool parallel;
uniform vec3 towardsEye;
vec3 view_of(vec3 p) { return parallel ? towardsEye : normalize(eye - p); }
// A sky, a lamp above the eye's shoulder, and a rim of light where the surface turns away.
vec3 lit(vec3 color, vec3 normal, vec3 view, float open) {
  float lamp = max(dot(normal, keyLight), 0.0);
  float sky = 0.5 + 0.5 * dot(normal, normalize(keyLight + view));
  float shine = pow(max(dot(normal, normalize(keyLight + view)), 0.0), 40.0);
  float rim = pow(1.0 - max(dot(normal, view), 0.0), 4.0);
  return color * (0.30 * open + 0.30 * sky * open + 0.52 * lamp * (0.4 + 0.6 * open)) + 0.07 * shine + 0.05 * rim * open;
}
`;

/// What slices hide nothing of: points that are, of every shown slice, on the eye's side, are cut away; and what is beyond
/// the clip plane.
export const kCutShader = `
uniform vec3 cutSide, cutAt;  // per axis: -1 or 1, the side that the eye is on, 0: no slice; and where
uniform vec4 clip;            // away where the first three times the point exceed the fourth
bool cut_away(vec3 p) {
  if (dot(clip.xyz, p) > clip.w) return true;
  vec3 beside = (p - cutAt) * cutSide + 0.004;  // a little more: no rim of it stands in front of the slice
  bvec3 free = bvec3(cutSide.x == 0.0 || beside.x > 0.0, cutSide.y == 0.0 || beside.y > 0.0, cutSide.z == 0.0 || beside.z > 0.0);
  return any(notEqual(cutSide, vec3(0.0))) && all(free);
}
`;
