// SPDX-License-Identifier: Apache-2.0
#include "io/zarr/blosc.h"

#ifdef STANDOFF_HAVE_BLOSC
#include <blosc.h>
#endif

#include "standoff/error.h"

namespace standoff::zarr {

#ifdef STANDOFF_HAVE_BLOSC

bool have_blosc() { return true; }

std::size_t blosc_most(std::size_t bytes) { return bytes + BLOSC_MAX_OVERHEAD; }

std::vector<std::byte> blosc_packed(std::span<const std::byte> bytes, int level, std::size_t block) {
  std::vector<std::byte> packed(blosc_most(bytes.size()));
  // The functions with _ctx have no state in common; one thread of their own, for our threads have a chunk each.
  const int size = ::blosc_compress_ctx(level, BLOSC_SHUFFLE, kNumberBytes, bytes.size(), bytes.data(), packed.data(),
                                        packed.size(), BLOSC_ZSTD_COMPNAME, block, 1);
  if (size <= 0)
    throw Error(ErrorCode::usage,
                "zarr: the blosc library of this machine cannot compress with zstd; install one that can");
  packed.resize(static_cast<std::size_t>(size));
  return packed;
}

std::string blosc_unpack(std::string_view packed, std::span<std::byte> out) {
  // The header, 16 bytes, says how long both are; blosc believes it.
  std::size_t size = 0;
  if (packed.size() < BLOSC_MIN_HEADER_LENGTH || ::blosc_cbuffer_validate(packed.data(), packed.size(), &size) != 0)
    return "its blosc header is damaged";
  if (size != out.size())
    return "its blosc header promises " + std::to_string(size) + " bytes, where a chunk has " +
           std::to_string(out.size());
  const int got = ::blosc_decompress_ctx(packed.data(), out.data(), out.size(), 1);
  if (got == static_cast<int>(out.size())) return {};
  const char* const name = ::blosc_cbuffer_complib(packed.data());
  if (got == -5)  // what blosc returns for a compressor that it was built without
    return std::string("it is compressed by ") + (name ? name : "what is unknown") +
           ", which the blosc library of this machine lacks; write the store by another";
  return "its compressed bytes are damaged";
}

#else

bool have_blosc() { return false; }
std::size_t blosc_most(std::size_t bytes) { return bytes; }
std::vector<std::byte> blosc_packed(std::span<const std::byte>, int, std::size_t) {
  throw Error(ErrorCode::internal, std::string("zarr: ") + kWithoutBlosc);
}
std::string blosc_unpack(std::string_view, std::span<std::byte>) { return kWithoutBlosc; }

#endif

}  // namespace standoff::zarr
