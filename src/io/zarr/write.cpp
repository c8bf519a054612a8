// SPDX-License-Identifier: Apache-2.0
#include "io/zarr/windows.h"

#include <fcntl.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <mutex>
#include <string>
#include <system_error>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "core/field_error.h"
#include "core/progress.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "files/atomic_file.h"
#include "io/zarr/blosc.h"
#include "io/zarr/parts.h"
#include "standoff/error.h"

namespace standoff::zarr {
namespace {

using Packed = std::vector<std::byte>;

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::usage, "zarr: " + what); }

// The bytes of a chunk in a file.
Packed packed_bytes(const ArrayLayout& layout, std::span<const std::uint32_t> chunk) {
  const auto bytes = std::as_bytes(chunk);
  Packed packed = layout.blosc ? blosc_packed(bytes) : Packed(bytes.begin(), bytes.end());
  if (!layout.checked) return packed;
  const std::uint32_t sum = crc32c(packed);
  const auto end = std::as_bytes(std::span(&sum, 1));
  packed.insert(packed.end(), end.begin(), end.end());
  return packed;
}

// Packs what an array holds of a field, chunk by chunk.
class ChunkPacker {
 public:
  ChunkPacker(const ArrayLayout& layout, const DistanceField& field) : layout_(layout), field_(field) {
    const auto bytes =
        layout.whole_numbers ? std::as_bytes(field.tile_nearest_values()) : std::as_bytes(field.tile_values());
    values_ = bytes.data();
    inside_ = layout.whole_numbers ? layout.fill : std::bit_cast<std::uint32_t>(-static_cast<float>(field.thickness()));
  }

  /// The chunk whose first sample is `first` of the field; nothing if all its samples have the fill value.
  Packed pack(const Size3& first) const {
    const Size3 whole = plus(first, layout_.chunk), end = least(whole, field_.grid().size);
    const Size3 begin_tile{first.x / kTileSide, first.y / kTileSide, first.z / kTileSide};
    const Size3 end_tile = parts_of(end, Size3{kTileSide, kTileSide, kTileSide});
    std::int64_t stored = 0, inside = 0;
    for_each_tile(begin_tile, end_tile, [&](const Size3&, std::int32_t slot) { ++(slot < 0 ? inside : stored); });
    if (stored == 0 && (inside == 0 || inside_ == layout_.fill)) return {};
    if (stored == 0 && end == whole && kTileSamples * inside == layout_.chunk.count()) return all_inside();
    const KeptByThread<std::vector<std::uint32_t>> chunk;
    chunk->assign(static_cast<std::size_t>(layout_.chunk.count()), layout_.fill);
    for_each_tile(begin_tile, end_tile,
                  [&](const Size3& tile, std::int32_t slot) { copy_tile(tile, slot, first, end, *chunk); });
    if (std::ranges::all_of(*chunk, [fill = layout_.fill](std::uint32_t value) { return value == fill; })) return {};
    return packed_bytes(layout_, *chunk);
  }

 private:
  template <class Visit>
  void for_each_tile(const Size3& begin, const Size3& end, const Visit& visit) const {
    const std::span<const std::int32_t> slots = field_.slots();
    if (slots.empty()) return;
    const Size3 tiles = field_.tile_count();
    for (std::int64_t z = begin.z; z < end.z; ++z)
      for (std::int64_t y = begin.y; y < end.y; ++y)
        for (std::int64_t x = begin.x; x < end.x; ++x) {
          const std::int32_t slot = slots[static_cast<std::size_t>(x + tiles.x * (y + tiles.y * z))];
          if (slot != DistanceField::kOutside) visit(Size3{x, y, z}, slot);
        }
  }
  // In a large solid these are most chunks.
  const Packed& all_inside() const {
    std::call_once(once_, [&] {
      all_inside_ = packed_bytes(layout_, std::vector(static_cast<std::size_t>(layout_.chunk.count()), inside_));
    });
    return all_inside_;
  }

  // The samples of the grid alone: those beyond it are the fill value, whatever the tile has there.
  void copy_tile(const Size3& tile, std::int32_t slot, const Size3& first, const Size3& end,
                 std::vector<std::uint32_t>& chunk) const {
    const Size3 at = times(tile, {kTileSide, kTileSide, kTileSide});
    const auto width = static_cast<std::size_t>(std::min<std::int64_t>(kTileSide, end.x - at.x));
    for (std::int64_t z = at.z; z < std::min(end.z, at.z + kTileSide); ++z)
      for (std::int64_t y = at.y; y < std::min(end.y, at.y + kTileSide); ++y) {
        std::uint32_t* const row =
            chunk.data() + (at.x - first.x) + layout_.chunk.x * ((y - first.y) + layout_.chunk.y * (z - first.z));
        if (slot < 0) {
          std::fill_n(row, width, inside_);
        } else {
          const std::int64_t from =
              std::int64_t{kTileSamples} * slot + kTileSide * ((y - at.y) + kTileSide * (z - at.z));
          std::memcpy(row, values_ + sizeof(float) * static_cast<std::size_t>(from), sizeof(float) * width);
        }
      }
  }

  const ArrayLayout& layout_;
  const DistanceField& field_;
  const std::byte* values_;
  std::uint32_t inside_;
  mutable std::once_flag once_;
  mutable Packed all_inside_;
};

// Packs `count` chunks on all threads, each by pack(n). While it waits, a thread takes up none of the other shards:
// else it would hold more and more of them.
template <class Pack>
std::vector<Packed> pack_all(std::size_t count, const Pack& pack) {
  std::vector<Packed> packed(count);
  tbb::this_task_arena::isolate(
      [&] { tbb::parallel_for(std::size_t{0}, count, [&](std::size_t n) { packed[n] = pack(n); }); });
  return packed;
}

// Takes note of where chunks will be in a file that has `size` bytes so far; returns what it has with them.
std::uint64_t enter(ShardIndex& index, std::uint64_t size, const std::vector<Packed>& packed, const Size3& first,
                    const Size3& parts) {
  for (std::size_t n = 0; n < packed.size(); ++n) {
    if (packed[n].empty()) continue;
    index[plus(first, part_at(n, parts))] = {size, packed[n].size()};
    size += packed[n].size();
  }
  return size;
}

std::vector<const StoredLayout*> layouts_of(const StoreMetadata& store) {
  std::vector<const StoredLayout*> layouts{&store.distance};
  if (store.nearest) layouts.push_back(&*store.nearest);
  return layouts;
}

// Of files that nobody else knows yet.
void append(const std::filesystem::path& path, std::span<const std::byte> bytes, const std::filesystem::path& shown) {
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  if (file.number() < 0) fail_to_write(shown, errno, path.parent_path());
  while (!bytes.empty()) {
    const auto wrote = ::write(file.number(), bytes.data(), bytes.size());
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) fail_to_write(shown, wrote < 0 ? errno : EIO, path.parent_path());
    bytes = bytes.subspan(static_cast<std::size_t>(wrote));
  }
}

// All of a shard, whose first sample is `first` of the window.
void write_shard(const StoredLayout& layout, const Size3& shard, const DistanceField& window, const Size3& first,
                 bool sync) {
  const Size3 parts = layout.chunks();
  const ChunkPacker packer(layout, window);
  const std::vector<Packed> packed = pack_all(static_cast<std::size_t>(parts.count()), [&](std::size_t n) {
    const Size3 at = plus(first, times(part_at(n, parts), layout.chunk));
    const Size3& size = window.grid().size;
    return at.x < size.x && at.y < size.y && at.z < size.z ? packer.pack(at) : Packed();
  });
  const std::filesystem::path path = layout.folder / layout.file_name(shard);
  ShardIndex index(parts);
  if (enter(index, 0, packed, {}, parts) == 0) {
    std::error_code error;
    std::filesystem::remove(path, error);
    if (error) fail_to_write(path, error.value(), path.parent_path());
    return;
  }
  make_folder(path.parent_path(), path);
  AtomicFile file(path);
  if (!sync) file.leave_to_system();
  for (const Packed& chunk : packed) file.write(chunk.data(), chunk.size());
  const std::vector<std::byte> end = index.bytes();
  file.write(end.data(), end.size());
  file.commit();
}

void check_layout(const StoredLayout& layout, double thickness) {
  const bool ours = layout.sharded && layout.x_fastest && !layout.index_first &&
                    std::bit_cast<float>(layout.fill) == static_cast<float>(thickness);
  for (const std::int64_t side : {layout.chunk.x, layout.chunk.y, layout.chunk.z})
    if (!ours || side % kTileSide != 0)
      refuse("the store is not laid out as standoff writes stores; make a new one and write that");
}

}  // namespace

void make_folder(const std::filesystem::path& folder, const std::filesystem::path& shown) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) fail_to_write(shown, error.value(), folder.parent_path());
}

void check_shards(const StoreMetadata& store, const Size3& first, const Size3& part) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t shard = store.distance.shard[axis], size = store.grid.size[axis], from = first[axis];
    const std::string along = std::string("along ") + "xyz"[axis] + " the window ";
    if (from < 0 || from >= size || part[axis] < 1 || part[axis] > size - from)
      refuse(along + "from sample " + std::to_string(from) + " on, of " + std::to_string(part[axis]) +
             " samples, is not within the grid's " + std::to_string(size) + "; give a part of the grid");
    const std::int64_t end = from + part[axis];
    if (from % shard != 0 || (end % shard != 0 && end != size))
      refuse(along + "is from sample " + std::to_string(from) + " to " + std::to_string(end) +
             ", and would write a part of a shard, of " + std::to_string(shard) +
             " samples, that another writer may write too; give whole shards");
  }
}

void check_window(const StoreMetadata& store, const Size3& first, const DistanceField& window) {
  check_layout(store.distance, store.thickness);
  const Grid &whole = store.grid, &part = window.grid();
  check_shards(store, first, part.size);
  if (part.spacing != whole.spacing) refuse("the window's spacing is not that of the store; give a part of its field");
  const Vec3 off = part.corner() - whole.position(first.x, first.y, first.z);
  constexpr double kSlack = 1e-3;  // of a spacing: where samples are is rounded, and a wrong place is one off or more
  if (std::abs(off.x) > kSlack * whole.spacing.x || std::abs(off.y) > kSlack * whole.spacing.y ||
      std::abs(off.z) > kSlack * whole.spacing.z)
    refuse("the window's origin is not at sample " + index_text(first.x, first.y, first.z) +
           " of the store's grid; give the window of that sample");
  if (static_cast<float>(window.thickness()) != static_cast<float>(store.thickness))
    refuse("the window's thickness is not that of the store; give a part of its field");
  if (window.has_nearest() != store.nearest.has_value())
    refuse(store.nearest ? "the store has nearest triangles, and the window has none; compute it with them"
                         : "the window has nearest triangles, and the store has none; make the store with them");
}

void check_writable(const Grid& grid, double thickness, const ZarrLayout& layout) {
  validate(grid);
  if (!(thickness > 0)) refuse("the thickness must be positive; give a positive one");
  std::int64_t chunks = 1, samples = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t chunk = layout.chunk[axis], shard = layout.shard[axis];
    constexpr std::int64_t kMostSide = std::int64_t{1} << 20;  // so that no product overflows
    if (chunk < kTileSide || chunk % kTileSide != 0 || chunk > kMostSide)
      refuse("a chunk of " + std::to_string(chunk) + " samples; give a multiple of 8, at most 2^20");
    if (shard < chunk || shard % chunk != 0 || shard > kMostSide)
      refuse("a shard of " + std::to_string(shard) + " samples; give a multiple of the chunk's " +
             std::to_string(chunk) + ", at most 2^20");
    chunks = std::min(chunks * (shard / chunk), kMostChunks + 1);
    samples = std::min(samples * chunk, std::int64_t{1} << 40);
  }
  if (samples > std::int64_t{1} << 24) refuse("a chunk has more than 2^24 samples; give a smaller one");
  if (chunks > kMostChunks) refuse("a shard has more than 2^20 chunks; give a smaller one");
  if (layout.compress && !have_blosc())
    refuse(std::string("chunks cannot be compressed: ") + kWithoutBlosc + ", or leave them uncompressed");
}

StoreMetadata metadata_of(const std::filesystem::path& path, const Grid& grid, double thickness,
                          const Provenance& provenance, const ZarrLayout& layout) {
  ArrayLayout array{.shape = grid.size, .shard = layout.shard, .chunk = layout.chunk, .blosc = layout.compress};
  array.fill = std::bit_cast<std::uint32_t>(static_cast<float>(thickness));
  // A window of a grid becomes a grid of its own.
  const Grid own{grid.size, grid.corner(), grid.spacing};
  StoreMetadata store{path, own, thickness, provenance, {array, path / kDistanceName}, {}, true, 1};
  array.whole_numbers = true;
  array.fill = kNoTriangle;
  if (layout.nearest) store.nearest = StoredLayout{array, path / kNearestName};
  return store;
}

void write_metadata(const StoreMetadata& store, const std::filesystem::path& folder,
                    const std::filesystem::path& shown) {
  const auto write = [&](const char* name, const std::string& text) {
    make_folder(folder / name, shown);
    append(folder / name / kMetadataName, std::as_bytes(std::span(text)), shown);
  };
  write(kDistanceName, distance_text(store));
  if (store.nearest) write(kNearestName, nearest_text(store));
  write(".", group_text(store));
}

void write_window(const StoreMetadata& store, const Size3& first, const DistanceField& window, bool sync, int threads,
                  ProgressMeter& meter) {
  check_window(store, first, window);
  const Size3 shard = store.distance.shard, shards = parts_of(window.grid().size, shard);
  const Size3 begin{first.x / shard.x, first.y / shard.y, first.z / shard.z};
  const auto count = static_cast<std::size_t>(shards.count());
  const std::vector<const StoredLayout*> layouts = layouts_of(store);
  meter.stage("writing", static_cast<std::int64_t>(count * layouts.size()), 0, 1);
  Threads(threads).run([&] {
    tbb::parallel_for(std::size_t{0}, count * layouts.size(), [&](std::size_t n) {
      meter.check();
      const Size3 at = part_at(n % count, shards);
      write_shard(*layouts[n / count], plus(begin, at), window, times(at, shard), sync);
      meter.advance();
    });
  });
}

LayeredWriter::LayeredWriter(const StoreMetadata& store, const std::filesystem::path& folder,
                             const std::filesystem::path& shown, int threads, ProgressMeter& meter)
    : store_(store), folder_(folder), shown_(shown), threads_(threads), meter_(meter) {
  for (const StoredLayout* layout : layouts_of(store)) {
    const Size3 shards = parts_of(layout->shape, layout->shard);
    arrays_.push_back({layout, std::vector<Shard>(static_cast<std::size_t>(shards.x * shards.y))});
  }
}

void LayeredWriter::write_layer(const DistanceField& field, std::int64_t first) {
  const std::int64_t per_shard = store_.distance.chunks().z;
  for (Array& array : arrays_) {
    Threads(threads_).run([&] {
      tbb::parallel_for(std::size_t{0}, array.shards.size(), [&](std::size_t shard) {
        meter_.check();
        write_chunks(array, shard, field, first);
      });
    });
    const bool last = (layer_ + 1) * slices() >= store_.grid.size.z;
    if (last || (layer_ + 1) % per_shard == 0) end_shards(array);
  }
  ++layer_;
}

Size3 LayeredWriter::shard_at(const Array& array, std::size_t shard) const {
  const Size3 shards = parts_of(array.layout->shape, array.layout->shard);
  Size3 at = part_at(shard, {shards.x, shards.y, 1});
  at.z = layer_ / array.layout->chunks().z;
  return at;
}

void LayeredWriter::write_chunks(Array& array, std::size_t shard, const DistanceField& field, std::int64_t first) {
  const StoredLayout& layout = *array.layout;
  const Size3 at = shard_at(array, shard), parts{layout.chunks().x, layout.chunks().y, 1};
  const ChunkPacker packer(layout, field);
  const std::vector<Packed> packed = pack_all(static_cast<std::size_t>(parts.count()), [&](std::size_t n) {
    const Size3 part = part_at(n, parts);
    const Size3 begin{at.x * layout.shard.x + part.x * layout.chunk.x, at.y * layout.shard.y + part.y * layout.chunk.y,
                      first};
    return begin.x < layout.shape.x && begin.y < layout.shape.y ? packer.pack(begin) : Packed();
  });
  if (std::ranges::all_of(packed, &Packed::empty)) return;
  Shard& state = array.shards[shard];
  if (state.size == 0) state.index = ShardIndex(layout.chunks());
  const bool create = state.size == 0;
  state.size = enter(state.index, state.size, packed, {0, 0, layer_ % layout.chunks().z}, parts);
  if (create) make_folder((folder_ / layout.folder.filename() / layout.file_name(at)).parent_path(), shown_);
  Packed together;  // one call for all: they are small
  for (const Packed& part : packed) together.insert(together.end(), part.begin(), part.end());
  append_to(array, shard, together);
}

void LayeredWriter::append_to(const Array& array, std::size_t shard, const Packed& bytes) const {
  const std::filesystem::path name = array.layout->folder.filename() / array.layout->file_name(shard_at(array, shard));
  append(folder_ / name, bytes, shown_);
}

void LayeredWriter::end_shards(Array& array) {
  for (std::size_t shard = 0; shard < array.shards.size(); ++shard) {
    Shard& state = array.shards[shard];
    if (state.size == 0) continue;
    append_to(array, shard, state.index.bytes());
    state = {};
  }
}

}  // namespace standoff::zarr
