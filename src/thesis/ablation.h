// How far the kernels go. The whole way, but where a part is left out to see what it costs, as Table 5.4 of the thesis
// does: two times, and their difference.
#pragma once

#include <cstdint>

namespace standoff::gpu {

/// Each goes farther than the one before. What a method does not have costs it nothing.
enum class Through {
  lists,     ///< tiles: lists made and walked through; thesis: samples walked through, with their positions
  set_up,    ///< triangles set up in shared memory
  vote,      ///< which triangles a warp must measure to
  distance,  ///< distances, and the least of them
  read,      ///< thesis: what the sample holds is read
  write,     ///< all: the field
  always,    ///< thesis: written without a look at what the sample holds
};

/// The bits of a float that no arithmetic gives. What is left out would happen at these: so the compiler must compute
/// all that comes before.
inline constexpr std::uint32_t kNever = 0x7fa00001u;

}  // namespace standoff::gpu
