#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <mutex>
#include <utility>

#include "core/field_bytes.h"
#include "core/guarded.h"
#include "standoff/error.h"
#include "standoff/field.h"

namespace standoff {
namespace {

constexpr int kSide = DistanceField::kTileSide;
constexpr int kSamples = DistanceField::kTileSamples;
constexpr std::int32_t kNotStored = -1;
// Tiles asked for at once: 512 KiB, small against any field worth storing, large against the cost of asking for it.
// Huge pages do not pay: a band of the catapult takes a fifth less time in them once they are there, but getting them
// anew costs twice what small ones do (factory: 0.69 s against 0.33).
constexpr std::int64_t kChunkTiles = 256;

constexpr std::int64_t tiles_along(std::int64_t samples) { return (samples + kSide - 1) / kSide; }
constexpr Size3 tiles_of(const Size3& samples) {
  return {tiles_along(samples.x), tiles_along(samples.y), tiles_along(samples.z)};
}
constexpr int within(std::int64_t i, std::int64_t j, std::int64_t k) {
  return static_cast<int>((i % kSide) + kSide * ((j % kSide) + kSide * (k % kSide)));
}

bool is_one_of(std::int64_t n, std::int64_t count) { return n >= 0 && n < count; }

// Throws Error{usage} with what `message` returns. Out of line: who asks for one sample passes no try block. Nor are
// the numbers that a message holds stored for it, as long as it captures them by value.
template <class Message>
[[noreturn, gnu::cold, gnu::noinline]] void fail(Message message) try {
  throw Error(ErrorCode::usage, "field: " + std::string(message()));
} catch (...) {
  throw_as_error("field");
}

[[noreturn]] void fail_without_nearest() {
  fail([] { return "it holds no nearest triangles; compute it with them"; });
}

std::string name(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
  return "(" + std::to_string(tx) + "," + std::to_string(ty) + "," + std::to_string(tz) + ")";
}

}  // namespace

// Tiles live in chunks that never move, so that threads fill tiles while others add some.
struct DistanceField::Pool {
  struct Chunk {
    std::unique_ptr<float[]> values;
    std::unique_ptr<std::uint32_t[]> nearest;
  };

  /// Forgets all tiles. Memory that is there stays for the next ones, as far as so many may use it.
  void clear(std::int64_t max_tiles, bool nearest) {
    chunks.resize(static_cast<std::size_t>((max_tiles + kChunkTiles - 1) / kChunkTiles));
    used = 0;
    with_nearest = nearest;
    if (!with_nearest)
      for (Chunk& chunk : chunks) chunk.nearest.reset();
  }
  std::int64_t add() {
    const std::lock_guard lock(grow);
    Chunk& chunk = chunks[used / kChunkTiles];
    if (!chunk.values) chunk.values = std::make_unique_for_overwrite<float[]>(kChunkTiles * kSamples);
    if (with_nearest && !chunk.nearest)
      chunk.nearest = std::make_unique_for_overwrite<std::uint32_t[]>(kChunkTiles * kSamples);
    return used++;
  }
  float* values(std::int64_t slot) const {
    return chunks[slot / kChunkTiles].values.get() + slot % kChunkTiles * kSamples;
  }
  std::uint32_t* nearest(std::int64_t slot) const {
    return chunks[slot / kChunkTiles].nearest.get() + slot % kChunkTiles * kSamples;
  }

  std::vector<Chunk> chunks;
  std::atomic<std::int64_t> used{0};
  std::mutex grow;
  bool with_nearest = false;
};

double field_bytes(double stored_tiles, double all_tiles, bool with_nearest) {
  constexpr double kTileBytes = sizeof(float) * kSamples;
  const auto chunks = [](double tiles) { return std::ceil(tiles / static_cast<double>(kChunkTiles)); };
  return chunks(stored_tiles) * kChunkTiles * kTileBytes * (with_nearest ? 2 : 1) + all_tiles * sizeof(std::int32_t) +
         chunks(all_tiles) * 2 * sizeof(void*);
}

DistanceField::DistanceField(const Grid& grid, double thickness, bool with_nearest) {
  reset(grid, thickness, with_nearest);
}

void DistanceField::reset(const Grid& grid, double thickness, bool with_nearest) try {
  validate(grid);
  if (!(thickness > 0))
    throw Error(ErrorCode::usage, "field: the thickness must be positive; infinity gives a full field");
  const std::int64_t tiles = tiles_of(grid.size).count();
  if (tiles > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::limit, "field: " + std::to_string(tiles) + " tiles are more than 2^31; take fewer samples");
  // Without a pool the field has no tiles, should memory run out on the way.
  std::unique_ptr<Pool> pool = std::exchange(pool_, nullptr);
  if (!pool) pool = std::make_unique<Pool>();
  provenance = {};
  grid_ = grid;
  thickness_ = thickness;
  with_nearest_ = with_nearest;
  slots_.assign(static_cast<std::size_t>(tiles), kNotStored);
  pool->clear(tiles, with_nearest);
  pool_ = std::move(pool);
} catch (...) {
  throw_as_error("field", "take fewer samples, or a machine with more");
}

DistanceField::DistanceField() = default;
DistanceField::~DistanceField() = default;

DistanceField::DistanceField(DistanceField&& other) noexcept { *this = std::move(other); }

DistanceField& DistanceField::operator=(DistanceField&& other) noexcept {
  // Each member of `other` becomes what a new field's is; to itself a field can be assigned as well.
  provenance = std::exchange(other.provenance, {});
  grid_ = std::exchange(other.grid_, kEmptyGrid);
  thickness_ = std::exchange(other.thickness_, kEmptyThickness);
  with_nearest_ = std::exchange(other.with_nearest_, false);
  slots_ = std::exchange(other.slots_, {});
  pool_ = std::exchange(other.pool_, nullptr);
  return *this;
}

DistanceField::DistanceField(const DistanceField& other) try
    : provenance(other.provenance),
      grid_(other.grid_),
      thickness_(other.thickness_),
      with_nearest_(other.with_nearest_),
      slots_(other.slots_.size(), kNotStored) {
  if (!other.pool_) return;
  pool_ = std::make_unique<Pool>();
  pool_->clear(static_cast<std::int64_t>(slots_.size()), with_nearest_);
  for (std::size_t t = 0; t < slots_.size(); ++t) {
    if (other.slots_[t] == kNotStored) continue;
    const std::int64_t slot = pool_->add();
    std::copy_n(other.pool_->values(other.slots_[t]), kSamples, pool_->values(slot));
    if (with_nearest_) std::copy_n(other.pool_->nearest(other.slots_[t]), kSamples, pool_->nearest(slot));
    slots_[t] = static_cast<std::int32_t>(slot);
  }
} catch (...) {
  throw_as_error("field", "take fewer samples, or a machine with more");
}

DistanceField& DistanceField::operator=(const DistanceField& other) try {
  if (this != &other) *this = DistanceField(other);
  return *this;
} catch (...) {
  throw_as_error("field", "take fewer samples, or a machine with more");
}

Size3 DistanceField::tile_count() const { return tiles_of(grid_.size); }

std::int64_t DistanceField::tile_index(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
  const Size3 n = tile_count();
  if (!is_one_of(tx, n.x) || !is_one_of(ty, n.y) || !is_one_of(tz, n.z))
    fail([=] { return "there is no tile " + name(tx, ty, tz) + "; ask for one of tile_count()"; });
  return tx + n.x * (ty + n.y * tz);
}

std::int64_t DistanceField::stored_tiles() const { return pool_ ? pool_->used.load() : 0; }

const float* DistanceField::tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
  const std::int64_t index = tile_index(tx, ty, tz);
  if (!pool_) return nullptr;
  const std::int32_t slot = slots_[static_cast<std::size_t>(index)];
  return slot == kNotStored ? nullptr : pool_->values(slot);
}

const std::uint32_t* DistanceField::tile_nearest(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
  const std::int64_t index = tile_index(tx, ty, tz);
  if (!pool_) return nullptr;
  if (!with_nearest_) fail_without_nearest();
  const std::int32_t slot = slots_[static_cast<std::size_t>(index)];
  return slot == kNotStored ? nullptr : pool_->nearest(slot);
}

std::int32_t& DistanceField::entry_of(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
  if (!pool_) fail([] { return "it is empty and has no room for tiles; make one with a grid"; });
  return slots_[static_cast<std::size_t>(tile_index(tx, ty, tz))];
}

float* DistanceField::store_tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) try {
  std::int32_t& entry = entry_of(tx, ty, tz);
  if (entry != kNotStored)
    fail([=] { return "the tile " + name(tx, ty, tz) + " is stored already; store each tile once"; });
  const std::int64_t slot = pool_->add();
  entry = static_cast<std::int32_t>(slot);
  return pool_->values(slot);
} catch (...) {
  throw_as_error("field", "take fewer samples, or a machine with more");
}

std::uint32_t* DistanceField::store_nearest(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
  const std::int32_t slot = entry_of(tx, ty, tz);
  if (slot == kNotStored || !with_nearest_)
    fail([=] {
      return "the tile " + name(tx, ty, tz) + " has no nearest triangles; store it first, in a field made with them";
    });
  return pool_->nearest(slot);
}

void DistanceField::expect_sample(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const Size3& n = grid_.size;
  if (!is_one_of(i, n.x) || !is_one_of(j, n.y) || !is_one_of(k, n.z))
    fail([=] { return "there is no sample " + name(i, j, k) + "; ask for one of grid()"; });
}

float DistanceField::value(std::int64_t i, std::int64_t j, std::int64_t k) const {
  expect_sample(i, j, k);
  const float* values = tile(i / kSide, j / kSide, k / kSide);
  return values ? values[within(i, j, k)] : static_cast<float>(thickness_);
}

std::uint32_t DistanceField::nearest(std::int64_t i, std::int64_t j, std::int64_t k) const {
  expect_sample(i, j, k);
  const std::uint32_t* indices = tile_nearest(i / kSide, j / kSide, k / kSide);
  return indices ? indices[within(i, j, k)] : kNoTriangle;
}

namespace {

// The cell that holds a point, along one axis: its first sample, and where in the cell the point lies.
struct AxisCell {
  std::int64_t first = 0;
  std::int64_t second = 0;
  double t = 0;
};

AxisCell axis_cell(double point, double origin, double spacing, std::int64_t size) {
  if (size == 1) return {};
  const double at = std::clamp((point - origin) / spacing, 0.0, static_cast<double>(size - 1));
  const auto first = std::min(static_cast<std::int64_t>(at), size - 2);
  return {first, first + 1, at - static_cast<double>(first)};
}

struct Cell {
  AxisCell x, y, z;
  std::array<double, 8> corner{};  // x fastest
};

Cell cell_at(const DistanceField& field, Vec3 p) {
  if (std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z))
    fail([] { return "the point to look at is not a number; give three numbers"; });
  const Grid& g = field.grid();
  Cell cell{axis_cell(p.x, g.origin.x, g.spacing.x, g.size.x), axis_cell(p.y, g.origin.y, g.spacing.y, g.size.y),
            axis_cell(p.z, g.origin.z, g.spacing.z, g.size.z)};
  int n = 0;
  for (const auto k : {cell.z.first, cell.z.second})
    for (const auto j : {cell.y.first, cell.y.second})
      for (const auto i : {cell.x.first, cell.x.second}) cell.corner[n++] = field.value(i, j, k);
  return cell;
}

// An infinite value at either end with a share in the result makes it infinite, never NaN.
double mix(double a, double b, double t) {
  if (a == b || t == 0) return a;
  return std::isinf(a) ? a : a + (b - a) * t;
}

}  // namespace

double DistanceField::interpolate(Vec3 point) const {
  const Cell cell = cell_at(*this, point);
  const auto& c = cell.corner;
  const auto row = [&](int n) { return mix(c[n], c[n + 1], cell.x.t); };
  return mix(mix(row(0), row(2), cell.y.t), mix(row(4), row(6), cell.y.t), cell.z.t);
}

Vec3 DistanceField::gradient(Vec3 point) const {
  const Cell cell = cell_at(*this, point);
  const auto& c = cell.corner;
  const double tx = cell.x.t, ty = cell.y.t, tz = cell.z.t;
  // Difference along one axis, interpolated bilinearly along the two others; `step` is that axis's stride in c.
  const auto slope = [&](int step, int u, double tu, int v, double tv) {
    const auto difference = [&](int n) { return c[n + step] == c[n] ? 0.0 : c[n + step] - c[n]; };
    return mix(mix(difference(0), difference(u), tu), mix(difference(v), difference(u + v), tu), tv);
  };
  return Vec3{slope(1, 2, ty, 4, tz), slope(2, 1, tx, 4, tz), slope(4, 1, tx, 2, ty)} / grid_.spacing;
}

namespace {

void expect_slices(const Grid& grid, std::int64_t first, std::int64_t count, std::size_t room) {
  const Size3& n = grid.size;
  if (first < 0 || first > n.z || count < 0 || count > n.z - first ||
      static_cast<std::int64_t>(room) != n.x * n.y * count)
    fail([] { return "slices to copy are out of range or do not fit the memory given; give it a value a sample"; });
}

// Copies slices of a tiled array into dense memory; `tile` returns a tile's samples or nullptr for `absent` throughout.
template <class T, class TileAt>
void copy_tiled(const DistanceField& field, std::int64_t first, std::int64_t count, T absent, TileAt tile, T* out) {
  const Size3 n = field.grid().size;
  for (std::int64_t k = first; k < first + count; ++k)
    for (std::int64_t j = 0; j < n.y; ++j)
      for (std::int64_t i = 0; i < n.x; i += kSide, out += std::min<std::int64_t>(kSide, n.x - (i - kSide))) {
        const auto run = std::min<std::int64_t>(kSide, n.x - i);
        if (const T* samples = tile(i / kSide, j / kSide, k / kSide))
          std::copy_n(samples + within(0, j, k), run, out);
        else
          std::fill_n(out, run, absent);
      }
}

}  // namespace

void DistanceField::copy_slices(std::int64_t first, std::int64_t count, std::span<float> out) const {
  expect_slices(grid_, first, count, out.size());
  copy_tiled<float>(
      *this, first, count, static_cast<float>(thickness_), [&](auto x, auto y, auto z) { return tile(x, y, z); },
      out.data());
}

void DistanceField::copy_nearest_slices(std::int64_t first, std::int64_t count, std::span<std::uint32_t> out) const {
  if (!with_nearest_) fail_without_nearest();
  expect_slices(grid_, first, count, out.size());
  copy_tiled<std::uint32_t>(
      *this, first, count, kNoTriangle, [&](auto x, auto y, auto z) { return tile_nearest(x, y, z); }, out.data());
}

std::vector<float> DistanceField::to_dense() const try {
  std::vector<float> values(static_cast<std::size_t>(grid_.sample_count()));
  copy_slices(0, grid_.size.z, values);
  return values;
} catch (...) {
  throw_as_error("field", "copy some slices at a time");
}

std::int64_t DistanceField::memory_bytes() const {
  const auto tile_bytes = static_cast<std::int64_t>(sizeof(float) * kSamples * (with_nearest_ ? 2 : 1));
  const auto table_bytes = static_cast<std::int64_t>(slots_.size() * sizeof(std::int32_t));
  return stored_tiles() * tile_bytes + table_bytes;
}

DistanceField DistanceField::from_dense(const Grid& grid, double thickness, std::span<const float> values,
                                        std::span<const std::uint32_t> nearest) try {
  DistanceField field(grid, thickness, !nearest.empty());
  const auto samples = static_cast<std::size_t>(grid.sample_count());
  if (values.size() != samples || (!nearest.empty() && nearest.size() != samples))
    throw Error(ErrorCode::usage, "field: " + std::to_string(values.size()) + " values given for " +
                                      std::to_string(samples) + " samples; give one for each");
  const auto far = static_cast<float>(thickness);
  const Size3 tiles = field.tile_count();
  std::array<float, kSamples> tile;
  std::array<std::uint32_t, kSamples> tile_nearest;
  for (std::int64_t tz = 0; tz < tiles.z; ++tz)
    for (std::int64_t ty = 0; ty < tiles.y; ++ty)
      for (std::int64_t tx = 0; tx < tiles.x; ++tx) {
        tile.fill(far);
        tile_nearest.fill(kNoTriangle);
        bool needed = false;
        for (std::int64_t k = tz * kSide; k < std::min((tz + 1) * kSide, grid.size.z); ++k)
          for (std::int64_t j = ty * kSide; j < std::min((ty + 1) * kSide, grid.size.y); ++j)
            for (std::int64_t i = tx * kSide; i < std::min((tx + 1) * kSide, grid.size.x); ++i) {
              const auto from = grid.index(i, j, k);
              tile[within(i, j, k)] = values[from];
              if (!nearest.empty()) tile_nearest[within(i, j, k)] = nearest[from];
              needed |= !(values[from] >= far) || (!nearest.empty() && nearest[from] != kNoTriangle);
            }
        if (!needed) continue;
        std::ranges::copy(tile, field.store_tile(tx, ty, tz));
        if (!nearest.empty()) std::ranges::copy(tile_nearest, field.store_nearest(tx, ty, tz));
      }
  return field;
} catch (...) {
  throw_as_error("field", "take fewer samples, or a machine with more");
}

}  // namespace standoff
