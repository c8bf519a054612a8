// SPDX-License-Identifier: Apache-2.0
// A window is read in regions, each as large as a shard: its files are opened and their indices read; then in blocks,
// each as large as a chunk, which are unpacked and cut into tiles. Where the window begins at a chunk, a block is a
// chunk; else blocks are larger, for a chunk that lies in many blocks is unpacked for each of them.
#include "io/zarr/windows.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "core/memory.h"
#include "core/progress.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "files/file_view.h"
#include "io/field/tile_content.h"
#include "io/zarr/parts.h"
#include "io/zarr/shard.h"
#include "standoff/error.h"

namespace standoff::zarr {
namespace {

constexpr Size3 kTile{kTileSide, kTileSide, kTileSide};

// What a thread needs to unpack.
struct Scratch {
  UnpackedBytes packed, chunk, values, nearest;
};

// Numbers of 4 bytes, where sample (i,j,k) is in an array of them.
struct Strides {
  Size3 step;
  std::int64_t at(const Size3& sample) const { return sample.x * step.x + sample.y * step.y + sample.z * step.z; }
};
constexpr Strides strides_of(const Size3& size, bool x_fastest) {
  return x_fastest ? Strides{{1, size.x, size.x * size.y}} : Strides{{size.y * size.z, size.z, 1}};
}

// The files of an array that a window touches.
class OpenShards {
 public:
  OpenShards(const StoredLayout& layout, const Window& window)
      : layout_(layout), shards_(parts_in(window, layout.shard)) {
    const Size3 count = shards_.size();
    for (std::size_t n = 0; n < static_cast<std::size_t>(count.count()); ++n)
      files_.emplace_back(layout, plus(shards_.first, part_at(n, count)));
  }

  /// Whether a chunk that the window touches is stored.
  bool any(const Window& window) const {
    bool any = false;
    for_each_chunk(window, [&](const Size3& chunk) { any = any || stored(chunk); });
    return any;
  }

  /// Reads all samples of a window, x fastest.
  void read(const Window& window, std::uint32_t* out, Scratch& scratch) const {
    for_each_chunk(window, [&](const Size3& chunk) {
      const Size3 first = times(chunk, layout_.chunk);
      const Window whole{first, plus(first, layout_.chunk)};
      const Window part = whole.common(window);
      if (!stored(chunk)) return fill(part, window, out);
      if (whole == window && layout_.x_fastest) return unpack(chunk, out, scratch);
      auto* const unpacked =
          reinterpret_cast<std::uint32_t*>(scratch.chunk.room(static_cast<std::uint64_t>(layout_.chunk_bytes())));
      unpack(chunk, unpacked, scratch);
      copy(unpacked, whole, part, window, out);
    });
  }

 private:
  template <class Visit>
  void for_each_chunk(const Window& window, const Visit& visit) const {
    const Window chunks = parts_in(window, layout_.chunk);
    const Size3 count = chunks.size();
    for (std::size_t n = 0; n < static_cast<std::size_t>(count.count()); ++n)
      visit(plus(chunks.first, part_at(n, count)));
  }
  const StoredShard& file_of(const Size3& chunk) const {
    const Size3 at = minus(divided(chunk, layout_.chunks()), shards_.first), count = shards_.size();
    return files_[static_cast<std::size_t>(at.x + count.x * (at.y + count.y * at.z))];
  }
  Size3 in_file(const Size3& chunk) const {
    const Size3 chunks = layout_.chunks();
    return {chunk.x % chunks.x, chunk.y % chunks.y, chunk.z % chunks.z};
  }
  bool stored(const Size3& chunk) const { return file_of(chunk).stored(in_file(chunk)); }
  void unpack(const Size3& chunk, std::uint32_t* out, Scratch& scratch) const {
    file_of(chunk).read(in_file(chunk),
                        std::as_writable_bytes(std::span(out, static_cast<std::size_t>(layout_.chunk.count()))),
                        scratch.packed);
  }

  // The rows of a part of a window, by the place of their first samples.
  template <class Visit>
  static void for_each_row(const Window& part, const Visit& visit) {
    for (std::int64_t z = part.first.z; z < part.end.z; ++z)
      for (std::int64_t y = part.first.y; y < part.end.y; ++y) visit(Size3{part.first.x, y, z});
  }
  void fill(const Window& part, const Window& window, std::uint32_t* out) const {
    const Strides to = strides_of(window.size(), true);
    for_each_row(part, [&](const Size3& row) {
      std::fill_n(out + to.at(minus(row, window.first)), part.size().x, layout_.fill);
    });
  }
  void copy(const std::uint32_t* chunk, const Window& whole, const Window& part, const Window& window,
            std::uint32_t* out) const {
    const Strides from = strides_of(layout_.chunk, layout_.x_fastest), to = strides_of(window.size(), true);
    for_each_row(part, [&](const Size3& row) {
      const std::uint32_t* source = chunk + from.at(minus(row, whole.first));
      std::uint32_t* const target = out + to.at(minus(row, window.first));
      for (std::int64_t x = 0; x < part.size().x; ++x, source += from.step.x) target[x] = *source;
    });
  }

  const StoredLayout& layout_;
  Window shards_;
  std::vector<StoredShard> files_;
};

class WindowReader {
 public:
  WindowReader(const StoreMetadata& store, const Window& window, DistanceField& field, std::int64_t memory_limit,
               ProgressMeter& meter)
      : store_(store),
        window_(window),
        field_(field),
        memory_limit_(memory_limit),
        meter_(meter),
        file_(store.distance.folder, std::string_view()),
        far_(static_cast<float>(store.thickness)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t chunk = store.distance.chunk[axis], shard = store.distance.shard[axis];
      const bool aligned = chunk % kTileSide == 0 && window.first[axis] % chunk == 0;
      block_[axis] = aligned ? chunk : in_tiles(std::max<std::int64_t>(chunk, kMostBlock));
      region_[axis] = std::max(block_[axis], aligned ? shard : in_tiles(shard)) / block_[axis] * block_[axis];
      // A store that is not sharded has very many files, of one chunk each.
      if (!store.distance.sharded) region_[axis] = std::max(region_[axis], kMostBlock / block_[axis] * block_[axis]);
      const std::int64_t whole = in_tiles(window.size()[axis]);
      block_[axis] = std::min(block_[axis], whole);
      region_[axis] = std::min(region_[axis], whole);
    }
  }

  void read() {
    const Size3 size = window_.size(), regions = parts_of(size, region_);
    check_scratch();
    meter_.stage("reading", regions.count(), 0, 1);
    Threads(0).run([&] {
      tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(regions.count()), [&](std::size_t n) {
        const Size3 first = times(part_at(n, regions), region_);
        read_region({first, least(plus(first, region_), size)});
        meter_.advance();
      });
    });
  }

 private:
  static constexpr std::int64_t kMostBlock = 128;
  static std::int64_t in_tiles(std::int64_t samples) { return parts_of(samples, kTileSide) * kTileSide; }

  // The window's samples as the store's.
  Window in_store(const Window& part) const { return {plus(part.first, window_.first), plus(part.end, window_.first)}; }

  void check_scratch() {
    const auto bytes = [&](const StoredLayout& layout) {
      return 2.0 * static_cast<double>(layout.chunk_bytes()) + 4.0 * static_cast<double>(block_.count());
    };
    const double each = bytes(store_.distance) + (store_.nearest ? bytes(*store_.nearest) : 0);
    held_ = each * Threads(0).count();
    check_memory(0);
  }

  void check_memory(std::int64_t tiles) const {
    if (memory_limit_ == 0) return;
    const double needed = held_ + field_bytes(static_cast<double>(tiles),
                                              static_cast<double>(field_.tile_count().count()), field_.has_nearest());
    if (const auto limit = static_cast<double>(memory_limit_); needed > limit)
      throw Error(ErrorCode::limit,
                  store_.path.string() + ": its tiles need more than " + over_the_limit(needed, limit) +
                      "; give a higher limit, or read a part",
                  limit_details(needed, limit));
  }

  void read_region(const Window& region) {
    meter_.check();
    const Window samples = in_store(region);
    const OpenShards values(store_.distance, samples);
    std::optional<OpenShards> nearest;
    if (store_.nearest) nearest.emplace(*store_.nearest, samples);
    if (is_background(values, nearest, samples)) return;
    const Size3 blocks = parts_of(region.size(), block_);
    // While it waits, a thread opens no other region.
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(blocks.count()), [&](std::size_t n) {
        meter_.check();
        const Size3 first = plus(region.first, times(part_at(n, blocks), block_));
        read_block({first, least(plus(first, block_), region.end)}, values, nearest);
      });
    });
  }

  // Whether nothing is stored there, and so all is outside.
  bool is_background(const OpenShards& values, const std::optional<OpenShards>& nearest, const Window& samples) const {
    const bool is_far = std::bit_cast<float>(store_.distance.fill) == far_;
    const bool has_none = !nearest || (store_.nearest->fill == kNoTriangle && !nearest->any(samples));
    return is_far && has_none && !values.any(samples);
  }

  void read_block(const Window& block, const OpenShards& values, const std::optional<OpenShards>& nearest) {
    const Window samples = in_store(block);
    if (is_background(values, nearest, samples)) return;
    Scratch& scratch = scratch_.local();
    const auto room = [&](UnpackedBytes& bytes) {
      return reinterpret_cast<std::uint32_t*>(bytes.room(4 * static_cast<std::uint64_t>(block.size().count())));
    };
    std::uint32_t *const of_values = room(scratch.values), *const of_nearest =
                                                               nearest ? room(scratch.nearest) : nullptr;
    values.read(samples, of_values, scratch);
    if (nearest) nearest->read(samples, of_nearest, scratch);
    const Window tiles = parts_in(block, kTile);
    for (std::size_t n = 0; n < static_cast<std::size_t>(tiles.size().count()); ++n)
      read_tile(plus(tiles.first, part_at(n, tiles.size())), block, of_values, of_nearest);
  }

  template <class Number>
  static void cut(const std::uint32_t* from, const Window& block, const Window& part, Number beyond,
                  std::array<Number, kTileSamples>& tile) {
    static_assert(sizeof(Number) == sizeof *from);
    tile.fill(beyond);
    const Strides strides = strides_of(block.size(), true);
    for (std::int64_t z = part.first.z; z < part.end.z; ++z)
      for (std::int64_t y = part.first.y; y < part.end.y; ++y)
        std::memcpy(tile.data() + kTileSide * ((y - part.first.y) + kTileSide * (z - part.first.z)),
                    from + strides.at(minus({part.first.x, y, z}, block.first)),
                    sizeof(Number) * static_cast<std::size_t>(part.size().x));
  }

  void read_tile(const Size3& tile, const Window& block, const std::uint32_t* values, const std::uint32_t* nearest) {
    const Size3 first = times(tile, kTile);
    const Window part = Window{first, plus(first, kTile)}.common(block);
    std::array<float, kTileSamples> of_tile;
    cut(values, block, part, far_, of_tile);
    const TileContent found = content(of_tile, far_, part.size().count());
    if (found == TileContent::bad) fail_at_bad(file_, of_tile, far_, plus(first, window_.first));
    std::array<std::uint32_t, kTileSamples> triangles;
    if (nearest) cut(nearest, block, part, kNoTriangle, triangles);
    // A distance that equals the thickness lies in the band: only its nearest triangle tells it from a clamped one.
    if (found == TileContent::near || (nearest && has_triangle(triangles))) {
      check_memory(++stored_);
      std::ranges::copy(of_tile, field_.store_tile(tile.x, tile.y, tile.z).begin());
      if (nearest) std::ranges::copy(triangles, field_.store_nearest(tile.x, tile.y, tile.z).begin());
    } else if (found == TileContent::inside) {
      field_.mark_inside(tile.x, tile.y, tile.z);
    }
  }

  const StoreMetadata& store_;
  const Window window_;
  DistanceField& field_;
  const std::int64_t memory_limit_;
  ProgressMeter& meter_;
  const FileView file_;  // for messages
  const float far_;
  Size3 block_, region_;  // samples
  double held_ = 0;       // bytes of all threads
  std::atomic<std::int64_t> stored_{0};
  tbb::enumerable_thread_specific<Scratch> scratch_;
};

void check_inside(const StoreMetadata& store, const Size3& first, const Size3& size) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t all = store.grid.size[axis];
    if (first[axis] >= 0 && size[axis] >= 1 && first[axis] < all && size[axis] <= all - first[axis]) continue;
    throw Error(ErrorCode::usage, "zarr: samples " + std::to_string(first[axis]) + " to " +
                                      std::to_string(first[axis]) + " + " + std::to_string(size[axis]) + " along " +
                                      "xyz"[axis] + " are not within the " + std::to_string(all) + " of " +
                                      store.path.string() + "; ask for a part of it");
  }
}

}  // namespace

DistanceField read_window(const StoreMetadata& store, const Size3& first, const Size3& size, std::int64_t memory_limit,
                          ProgressMeter& meter) {
  check_inside(store, first, size);
  const Grid grid = store.grid.window(first, size);
  if (const auto limit = static_cast<double>(memory_limit); memory_limit > 0) {
    const double least_bytes = field_bytes(0, static_cast<double>(tile_count(size)), store.nearest.has_value());
    if (least_bytes > limit)
      throw Error(ErrorCode::limit,
                  store.path.string() + ": its tiles need more than " + over_the_limit(least_bytes, limit) +
                      "; give a higher limit, or read a part",
                  limit_details(least_bytes, limit));
  }
  DistanceField field(grid, store.thickness, store.nearest.has_value());
  field.set_provenance(store.provenance);
  WindowReader(store, {first, plus(first, size)}, field, memory_limit, meter).read();
  return field;
}

}  // namespace standoff::zarr
