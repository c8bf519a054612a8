// SPDX-License-Identifier: Apache-2.0
#include "field_fuzz.h"
#include "io/field/npy.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Checksums keep damaged arrays from their reader, so it also gets the bytes themselves.
  const standoff::FileView view("fuzz", {reinterpret_cast<const char*>(data), size});
  try {
    const standoff::NpyArray array = standoff::read_npy(view, "array", view.bytes(), size);
    if (array.offset + array.bytes != size) std::abort();
  } catch (const standoff::Error&) {
  }
  return standoff::fuzz_field(standoff::read_npz, data, size);
}
