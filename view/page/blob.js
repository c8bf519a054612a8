// SPDX-License-Identifier: Apache-2.0
// What the program packs (packed_blob() and others in src/page/page.h): a header, and sections of bytes.

/// The bytes that a text stands for (RFC 4648).
export function fromBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let n = 0; n < raw.length; ++n) bytes[n] = raw.charCodeAt(n);
  return bytes;
}

/// The header of a packed mesh or field, with a function that gives the bytes of a section.
export async function unpacked(packed) {
  let bytes = packed instanceof ArrayBuffer ? new Uint8Array(packed) : packed;
  const isPlain = () => String.fromCharCode(...bytes.subarray(0, 4)) === 'SOPG';  // as no zlib stream begins
  if (!isPlain()) {
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  }
  if (!isPlain()) throw new Error('this is no data of a standoff page');
  const headerBytes = new DataView(bytes.buffer, bytes.byteOffset).getUint32(4, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(8, 8 + headerBytes)));
  let at = 8 + headerBytes;
  const sections = new Map();
  for (const [name, size] of header.sections) {
    sections.set(name, bytes.subarray(at, at + size));
    at += size;
  }
  return {header, section: name => sections.get(name)};
}

/// Numbers out of planes of bytes, the lowest bytes first: two to four planes.
export function fromPlanes(bytes, count, planes) {
  const numbers = new Uint32Array(count), third = planes > 2 ? 2 * count : -1, fourth = planes > 3 ? 3 * count : -1;
  for (let n = 0; n < count; ++n) {
    let number = bytes[n] | bytes[count + n] << 8;
    if (third > 0) number |= bytes[third + n] << 16;
    if (fourth > 0) number |= bytes[fourth + n] << 24;
    numbers[n] = number;
  }
  return numbers;
}

/// 0, 1, 2, 3 .. as 0, -1, 1, -2 ..
export const fromZigzag = n => (n >>> 1) ^ -(n & 1);

/// Numbers of seven bits a byte.
export function fromVarints(bytes, count) {
  const numbers = new Uint32Array(count);
  for (let n = 0, at = 0; n < count; ++n) {
    let value = 0, shift = 0, byte;
    do {
      byte = bytes[at++];
      value |= (byte & 127) << shift;
      shift += 7;
    } while (byte & 128);
    numbers[n] = value;
  }
  return numbers;
}
