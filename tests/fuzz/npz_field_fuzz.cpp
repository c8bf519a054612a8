#include "field_fuzz.h"
#include "io/npy.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Checksums keep damaged arrays from their reader, so it also gets the bytes themselves.
  const difi::FileView view("fuzz", {reinterpret_cast<const char*>(data), size});
  try {
    const difi::NpyArray array = difi::read_npy(difi::FieldInput(view), "array", 0, size);
    if (array.offset + array.bytes != size) std::abort();
  } catch (const difi::Error&) {
  }
  return difi::fuzz_field(difi::read_npz, data, size);
}
