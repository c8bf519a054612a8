// SPDX-License-Identifier: Apache-2.0
// A field on the graphics card: half floats, in units that keep them near 1.
import {kInfinite, kNoNumber} from './field_data.js';

// What stands for a sample without a value. Values are at most kMost; what is between comes from interpolation.
const kNone = 65504, kMost = 100;
/// Dense textures up to so many samples; beyond, stored tiles alone, each in a slot.
const kMostDense = 1 << 24;
const kSlot = 9;  // samples of a tile with the first of the next: cells are interpolated within a slot

const float = new Float32Array(1), floatBits = new Uint32Array(float.buffer);
/// The nearest half float's bits.
export function halfOf(value) {
  float[0] = value;
  const bits = floatBits[0];
  const sign = bits >>> 16 & 0x8000, exponent = (bits >>> 23 & 255) - 112, fraction = bits & 0x7fffff;
  if (exponent >= 31) return sign | 0x7bff;
  if (exponent <= 0) {
    if (exponent < -10) return sign;
    const shift = 14 - exponent, whole = fraction | 0x800000;
    return sign | (whole + (1 << shift - 1) >> shift);
  }
  return Math.min(sign | exponent << 10, sign | 0x7bff) + (fraction + 0x1000 >> 13);
}

/// The texture's number of every code, and the world units of 1.
export function halvesOf(field) {
  const unit = Math.max(...field.spacing, Math.max(...field.range.map(Math.abs), field.thickness ?? 0) / kMost);
  const halves = new Uint16Array(65536);
  for (let code = -32768; code < 32768; ++code)
    halves[code + 32768] = halfOf(code === kNoNumber || Math.abs(code) === kInfinite ? kNone : code * field.step / unit);
  return {halves, unit};
}

export function textureOf3D(gl, size, data, formats, filter) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_3D, texture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage3D(gl.TEXTURE_3D, 0, formats[0], ...size, 0, formats[1], formats[2], data);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, name, filter);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R])
    gl.texParameteri(gl.TEXTURE_3D, name, gl.CLAMP_TO_EDGE);
  return texture;
}

/// {texture, tiles, slots, unit, outside}: values in a texture of the grid's size; or of stored tiles, in so many slots per
/// axis, with a texture that says which slot each tile has.
export function fieldTextures(gl, field) {
  const most = gl.getParameter(gl.MAX_3D_TEXTURE_SIZE), [nx, ny, nz] = field.size;
  const dense = nx * ny * nz <= kMostDense && Math.max(nx, ny, nz) <= most;
  return dense ? denseTexture(gl, field) : sparseTexture(gl, field);
}

function sparseTexture(gl, field) {
  const {halves, unit} = halvesOf(field), [tx, ty] = field.tileCount;
  const side = Math.ceil(Math.cbrt(Math.max(1, field.stored))), slots = [side, side, Math.ceil(Math.max(1, field.stored) / side / side)];
  const size = slots.map(n => n * kSlot), data = new Uint16Array(size[0] * size[1] * size[2]);
  field.slots.forEach((slot, tile) => {
    if (slot < 0) return;
    const first = [8 * (tile % tx), 8 * (Math.floor(tile / tx) % ty), 8 * Math.floor(tile / (tx * ty))];
    const at = [slot % side, Math.floor(slot / side) % side, Math.floor(slot / side / side)].map(n => n * kSlot);
    for (let k = 0; k < kSlot; ++k)
      for (let j = 0; j < kSlot; ++j)
        for (let i = 0; i < kSlot; ++i) {
          const inner = i < 8 && j < 8 && k < 8;
          const code = inner ? field.codes[512 * slot + i + 8 * j + 64 * k]
            : field.code(...[i, j, k].map((n, axis) => Math.min(first[axis] + n, field.size[axis] - 1)));
          data[at[0] + i + size[0] * (at[1] + j + size[1] * (at[2] + k))] = halves[code + 32768];
        }
  });
  return {
    unit, slots, texture: textureOf3D(gl, size, data, [gl.R16F, gl.RED, gl.HALF_FLOAT], gl.LINEAR),
    tiles: textureOf3D(gl, field.tileCount, field.slots, [gl.R32I, gl.RED_INTEGER, gl.INT], gl.NEAREST),
    outside: field.outside * field.step / unit,
  };
}

// All samples.
function denseTexture(gl, field) {
  const {halves, unit} = halvesOf(field), [nx, ny, nz] = field.size;
  const data = new Uint16Array(nx * ny * nz);
  data.fill(halves[field.outside + 32768]);
  const inside = halves[32768 - field.outside], [tx, ty] = field.tileCount;
  field.slots.forEach((slot, tile) => {
    if (slot === -1) return;
    const x = 8 * (tile % tx), y = 8 * (Math.floor(tile / tx) % ty), z = 8 * Math.floor(tile / (tx * ty));
    const width = Math.min(8, nx - x);
    for (let k = 0; k < 8 && z + k < nz; ++k)
      for (let j = 0; j < 8 && y + j < ny; ++j) {
        const to = x + nx * (y + j + ny * (z + k));
        if (slot < 0) {
          data.fill(inside, to, to + width);
          continue;
        }
        const from = 512 * slot + 8 * j + 64 * k;
        for (let i = 0; i < width; ++i) data[to + i] = halves[field.codes[from + i] + 32768];
      }
  });
  return {unit, slots: [0, 0, 0], tiles: null, outside: 0, texture: textureOf3D(gl, field.size, data, [gl.R16F, gl.RED, gl.HALF_FLOAT], gl.LINEAR)};
}
