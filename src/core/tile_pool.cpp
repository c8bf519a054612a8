// SPDX-License-Identifier: Apache-2.0
#include "core/tile_pool.h"

#include <algorithm>
#include <string>

#include "standoff/error.h"

namespace standoff {
namespace {

// Values and nearest triangles are of the same size.
constexpr std::size_t kTileBytes = sizeof(float) * DistanceField::kTileSamples;
static_assert(sizeof(float) == sizeof(std::uint32_t));

std::size_t bytes_of(std::int64_t tiles) { return static_cast<std::size_t>(tiles) * kTileBytes; }
std::int64_t tiles_in(std::size_t bytes) { return static_cast<std::int64_t>(bytes / kTileBytes); }

}  // namespace

void TilePool::clear(std::int64_t max_tiles, bool with_nearest) {
  used_ = 0;
  room_ = 0;  // should memory run out below
  with_nearest_ = with_nearest;
  const std::int64_t most = in_steps(max_tiles);
  const auto make_room = [&](GrowingMemory& memory) {
    memory.reserve(bytes_of(most));
    memory.resize(std::min(memory.size(), bytes_of(most)));
    return tiles_in(memory.size());
  };
  std::int64_t room = make_room(values_);
  if (with_nearest)
    room = std::min(room, make_room(nearest_));
  else
    nearest_.release();
  room_ = room;
}

void TilePool::copy_from(const TilePool& other) {
  const std::int64_t tiles = other.size();
  grow(tiles);
  std::copy_n(other.values(0), tiles * DistanceField::kTileSamples, values(0));
  if (with_nearest_) std::copy_n(other.nearest(0), tiles * DistanceField::kTileSamples, nearest(0));
  used_ = tiles;
}

std::int64_t TilePool::add() {
  std::int64_t slot = used_;
  // A slot is taken only when its memory is there: what fails leaves the pool as it was, whatever others do meanwhile.
  do {
    if (slot >= room_) grow(slot + 1);
  } while (!used_.compare_exchange_weak(slot, slot + 1));
  return slot;
}

void TilePool::grow(std::int64_t tiles) {
  const std::lock_guard lock(growing_);
  if (tiles <= room_) return;
  const std::int64_t room = in_steps(tiles);
  const std::size_t bytes = bytes_of(room);
  if (bytes > values_.room() || (with_nearest_ && bytes > nearest_.room()))
    throw Error(ErrorCode::limit, "field: " + std::to_string(tiles) +
                                      " tiles need more memory addresses than this process may use; raise its limit "
                                      "(RLIMIT_AS), take fewer samples or a smaller thickness");
  // One of them may be there from before.
  if (bytes > values_.size()) values_.resize(bytes);
  if (with_nearest_ && bytes > nearest_.size()) nearest_.resize(bytes);
  room_ = room;
}

}  // namespace standoff
