// SPDX-License-Identifier: Apache-2.0
// Fields as pages hold them.

#include <algorithm>
#include <array>
#include <cmath>

#include "core/number_text.h"
#include "core/tile_count.h"
#include "page/page.h"
#include "standoff/error.h"
#include "standoff/slice.h"

namespace standoff::page {
namespace {

// A step is this part of a spacing: far below the error of interpolation between samples. Finer steps make larger
// pages.
constexpr double kStepsPerSpacing = 128;
// Where all values are small beside the spacing, they still have so many steps.
constexpr double kLeastSteps = 2048;

double step_for(const Grid& grid, double greatest) {
  if (!(greatest > 0)) return 1;
  const double step =
      std::max(greatest / kMostCode, std::min(grid.max_spacing() / kStepsPerSpacing, greatest / kLeastSteps));
  return step > 0 ? step : 1;
}

// Textures have so many texels per side at the most: samples of a dense one, tiles of a sparse one's index.
constexpr std::int64_t kMostPerSide = 2048;
constexpr std::int64_t kMostTiles = std::int64_t{1} << 24;

Size3 thinned(const Size3& size, std::int64_t every) {
  const auto left = [every](std::int64_t n) { return (n - 1) / every + 1; };
  return {left(size.x), left(size.y), left(size.z)};
}

// Whether a page may hold a grid: all its samples, or those of its stored tiles, `stored` of them.
bool fits(const Size3& size, double stored, std::int64_t most) {
  const auto per_side = [](const Size3& n) { return std::max({n.x, n.y, n.z}); };
  if (per_side(size) <= kMostPerSide && size.count() <= most) return true;
  const Size3 tiles = DistanceField::tiles_of(size);
  return per_side(tiles) <= kMostPerSide && tiles.count() <= kMostTiles && stored <= static_cast<double>(most);
}

class Coder {
 public:
  Coder(const DistanceField& field, const CodedField& to) : field_(field), to_(to) {}

  std::int32_t code(float value) const {
    if (std::isnan(value)) return kNoNumberCode;
    if (std::isinf(value)) return value > 0 ? kInfiniteCode : -kInfiniteCode;
    if (to_.clamped == 0) return static_cast<std::int32_t>(std::lround(value / to_.step));
    const std::int32_t sign = std::signbit(value) ? -1 : 1;
    const double magnitude = std::abs(static_cast<double>(value));
    if (magnitude >= static_cast<double>(static_cast<float>(field_.thickness()))) return sign * to_.clamped;
    return sign * std::min(static_cast<std::int32_t>(std::lround(magnitude / to_.step)), to_.clamped - 1);
  }

 private:
  const DistanceField& field_;
  const CodedField& to_;
};

// Corner sums over the cube before a sample: what trilinear numbers have is predicted exactly.
std::int32_t predicted(const std::int32_t* codes, int i, int j, int k) {
  const auto at = [&](int di, int dj, int dk) {
    return codes[(i - di) + kTileSide * ((j - dj) + kTileSide * (k - dk))];
  };
  const int known = (i > 0) + 2 * (j > 0) + 4 * (k > 0);
  switch (known) {
    case 0:
      return 0;
    case 1:
      return i > 1 ? 2 * at(1, 0, 0) - at(2, 0, 0) : at(1, 0, 0);
    case 2:
      return j > 1 ? 2 * at(0, 1, 0) - at(0, 2, 0) : at(0, 1, 0);
    case 4:
      return k > 1 ? 2 * at(0, 0, 1) - at(0, 0, 2) : at(0, 0, 1);
    case 3:
      return at(1, 0, 0) + at(0, 1, 0) - at(1, 1, 0);
    case 5:
      return at(1, 0, 0) + at(0, 0, 1) - at(1, 0, 1);
    case 6:
      return at(0, 1, 0) + at(0, 0, 1) - at(0, 1, 1);
    default:
      return at(1, 0, 0) + at(0, 1, 0) + at(0, 0, 1) - at(1, 1, 0) - at(1, 0, 1) - at(0, 1, 1) + at(1, 1, 1);
  }
}

std::string coded_values(const CodedField& field) {
  std::vector<std::uint32_t> rest(field.codes.size());
  std::int32_t first = 0;  // of the tile before
  for (std::size_t tile = 0; tile < field.codes.size(); tile += kTileSamples) {
    const std::int32_t* codes = &field.codes[tile];
    for (int k = 0, n = 0; k < kTileSide; ++k)
      for (int j = 0; j < kTileSide; ++j)
        for (int i = 0; i < kTileSide; ++i, ++n)
          rest[tile + static_cast<std::size_t>(n)] = zigzag(codes[n] - (n == 0 ? first : predicted(codes, i, j, k)));
    first = codes[0];
  }
  std::string bytes;
  put_planes(bytes, rest, 3);  // sums of seven 16-bit numbers
  return bytes;
}

// Values as they are, for readers that wait: little endian, 16 bits.
std::string plain_values(const CodedField& field) {
  std::string bytes(2 * field.codes.size(), '\0');
  for (std::size_t n = 0; n < field.codes.size(); ++n) {
    const auto code = static_cast<std::uint16_t>(field.codes[n]);
    bytes[2 * n] = static_cast<char>(code & 255);
    bytes[2 * n + 1] = static_cast<char>(code >> 8);
  }
  return bytes;
}

// The triangle of a sample is guessed from the samples before it along x, y and z: the one on which two of them agree.
std::string coded_nearest(const CodedField& field) {
  std::string bytes;
  std::uint32_t last = 0;
  for (std::size_t n = 0; n < field.nearest.size(); ++n) {
    const std::uint32_t* const at = &field.nearest[n];
    const bool i = n % kTileSide > 0, j = n / kTileSide % kTileSide > 0, k = n % kTileSamples >= kTileSide * kTileSide;
    std::uint32_t guess = i ? at[-1] : j ? at[-kTileSide] : k ? at[-kTileSide * kTileSide] : last;
    if (j && k && at[-kTileSide] == at[-kTileSide * kTileSide]) guess = at[-kTileSide];
    put_varint(bytes, zigzag(static_cast<std::int32_t>(*at - guess)));
    last = *at;
  }
  return bytes;
}

// Every `every`-th sample.
CodedField coded_every(const DistanceField& field, std::int64_t every) {
  CodedField made{.every = every};
  const Grid& whole = field.grid();
  made.grid = {thinned(whole.size, every), whole.corner(), whole.spacing * double(every)};

  // Of all samples, which a thinned field may not hold all.
  if (std::isfinite(field.thickness()) || field.stored_tiles() == 0) made.max = field.thickness();
  double greatest = std::isfinite(field.thickness()) ? field.thickness() : 0;
  for (const float value : field.tile_values()) {
    if (std::isnan(value)) continue;
    made.min = std::min(made.min, double{value});
    made.max = std::max(made.max, double{value});
    if (std::isfinite(value)) greatest = std::max(greatest, std::abs(double{value}));
  }
  if (std::ranges::count(field.slots(), DistanceField::kInside) > 0) made.min = -field.thickness();
  made.min = std::min(made.min, made.max);
  made.step = step_for(made.grid, greatest);
  if (std::isfinite(field.thickness()))
    made.clamped =
        static_cast<std::int32_t>(std::clamp(std::lround(field.thickness() / made.step), 1L, long{kMostCode}));
  const Coder coder(field, made);

  const Size3 tiles = DistanceField::tiles_of(made.grid.size);
  std::array<std::int32_t, kTileSamples> codes{};
  std::array<std::uint32_t, kTileSamples> nearest{};
  for (std::int64_t tz = 0; tz < tiles.z; ++tz)
    for (std::int64_t ty = 0; ty < tiles.y; ++ty)
      for (std::int64_t tx = 0; tx < tiles.x; ++tx) {
        if (every == 1 && !field.tile(tx, ty, tz)) {
          made.tiles += static_cast<char>(field.background(tx, ty, tz) < 0);
          continue;
        }
        const std::int32_t inside = -made.clamped;
        bool outside_all = made.clamped != 0, inside_all = made.clamped != 0;
        std::int32_t last = 0;
        std::uint32_t last_nearest = kNoTriangle;
        for (int k = 0, n = 0; k < kTileSide; ++k)
          for (int j = 0; j < kTileSide; ++j)
            for (int i = 0; i < kTileSide; ++i, ++n) {
              const std::int64_t x = kTileSide * tx + i, y = kTileSide * ty + j, z = kTileSide * tz + k;
              if (x < made.grid.size.x && y < made.grid.size.y && z < made.grid.size.z) {
                last = coder.code(field.value(x * every, y * every, z * every));
                if (field.has_nearest()) last_nearest = field.nearest(x * every, y * every, z * every);
                outside_all = outside_all && last == made.clamped;
                inside_all = inside_all && last == inside;
              }
              codes[static_cast<std::size_t>(n)] = last;  // beyond the grid: what costs no bits
              nearest[static_cast<std::size_t>(n)] = last_nearest;
            }
        made.tiles += static_cast<char>(outside_all ? 0 : inside_all ? 1 : 2);
        if (outside_all || inside_all) continue;
        ++made.stored;
        made.codes.insert(made.codes.end(), codes.begin(), codes.end());
        if (field.has_nearest()) made.nearest.insert(made.nearest.end(), nearest.begin(), nearest.end());
      }
  return made;
}

// Pages compute with floats of 32 bits. Errors: usage.
void check_range(const std::string& name, const Grid& grid, double greatest) {
  constexpr double kLeast = 1e-33, kMost = 1e33, kFarthest = 1e6;  // the last in spacings
  const auto fits = [](double size) { return size == 0 || !std::isfinite(size) || (size >= kLeast && size <= kMost); };
  const Box box = grid.bounds();
  const double far = std::max(max_norm(box.min), max_norm(box.max)), extent = max_norm(box.extent());
  if (!fits(grid.spacing.x) || !fits(grid.spacing.y) || !fits(grid.spacing.z) || !fits(extent) || !fits(greatest))
    throw Error(ErrorCode::usage, "make_page: field '" + name +
                                      "': its spacing or its values are below 1e-33 or above 1e33, which pages cannot "
                                      "show; scale it, or draw pictures of it (standoff slice)");
  if (far > kFarthest * std::max(extent, grid.max_spacing()))
    throw Error(ErrorCode::usage, "make_page: field '" + name +
                                      "': it lies more than a million times its size from the origin, where pages "
                                      "cannot show it; move it, or draw pictures of it (standoff slice)");
}

// Where a plane lies along its axis, from 0 to 1.
double share_of(const SlicePlane& plane, const DistanceField& field) {
  const Size3& size = field.grid().size;
  const std::int64_t last = std::array{size.x, size.y, size.z}[static_cast<std::size_t>(plane.axis)] - 1;
  return last > 0 ? static_cast<double>(plane.index) / static_cast<double>(last) : 0.5;
}

}  // namespace

CodedField coded_field(const DistanceField& field, const PageOptions& options) {
  const Size3& size = field.grid().size;
  const double stored = static_cast<double>(field.stored_tiles()) * kTileSamples;
  // A band is a surface: of its tiles, one in every^2 is left, or so.
  const auto expected = [&](std::int64_t n) { return stored / static_cast<double>(n * n); };
  std::int64_t every = 1;
  while (!fits(thinned(size, every), expected(every), options.most_samples)) ++every;
  for (;; ++every) {
    CodedField made = coded_every(field, every);
    if (fits(made.grid.size, static_cast<double>(made.stored) * kTileSamples, options.most_samples)) return made;
  }
}

std::string field_blob(const PageField& field, const PageOptions& options, PageItem* held) {
  if (!field.field) throw Error(ErrorCode::usage, "make_page: field '" + field.name + "' is null; give a field");
  const DistanceField& given = *field.field;
  const CodedField made = coded_field(given, options);
  check_range(field.name, given.grid(), std::max(std::abs(made.min), std::abs(made.max)));
  const Provenance& from = given.provenance();
  const SlicePlane plane = slice_plane(given);
  JsonObject header;
  header.add("kind", "\"field\"")
      .add("name", json_string(field.name))
      .add("size", json_triple(made.grid.size))
      .add("origin", json_triple(made.grid.origin))
      .add("spacing", json_triple(made.grid.spacing))
      .add("given", json_triple(given.grid().size))
      .add("every", json_number(made.every))
      .add("step", json_number(made.step))
      .add("clamped", json_number(std::int64_t{made.clamped}))
      .add("thickness", json_number(given.thickness()))
      .add("min", json_number(made.min))
      .add("max", json_number(made.max))
      .add("plane", json_number(static_cast<std::int64_t>(plane.axis)))
      .add("plane_at", json_number(share_of(plane, given)))
      .add("signed", json_bool(given.has_sign()))
      .add("method", json_string(from.method))
      .add("sign", json_string(from.sign))
      .add("version", json_string(from.version))
      .add("mesh_hash", from.mesh_hash == 0 ? "null" : json_string(hash_text(from.mesh_hash)))
      .add("stored", json_number(made.stored))
      .add("nearest", json_bool(given.has_nearest()));
  const bool plain = options.compression == 0;
  std::vector<Section> sections{{"tiles", made.tiles}, {"nearest", coded_nearest(made)}};
  sections.push_back(plain ? Section{"plain", plain_values(made)} : Section{"values", coded_values(made)});
  std::string bytes = packed_blob(header, sections, options.compression);
  if (held)
    *held = {.name = field.name,
             .bytes = static_cast<std::int64_t>(bytes.size()),
             .every = made.every,
             // Values just below the thickness are a step lower, so that none of them counts as clamped.
             .error = made.step * (made.clamped == 0 ? 0.500001 : 1.500001)};
  return bytes;
}

}  // namespace standoff::page
