// SPDX-License-Identifier: Apache-2.0
// Reads the arrays of a file tile by tile.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <string_view>

#include "files/file_view.h"
#include "io/field/samples.h"

namespace standoff {

/// Reads tiles of an array, a layer of them after the other: a layer spans the grid but for its slowest axis, along
/// which it is a tile thick. Each number is read on its own: numbers need not be aligned.
template <class Sample>
class TileReader {
 public:
  TileReader(const FileView& file, const StoredArray& array, const Size3& size)
      : swapped_(array.big_endian),
        size_(size),
        step_(array.z_fastest ? Size3{size.y * size.z, size.z, 1} : Size3{1, size.x, size.x * size.y}),
        planes_(array.z_fastest ? size.x : size.z),
        plane_(size.count() / planes_),
        width_(array.planar ? 1 : array.components) {
    stream_ = array.open ? array.open() : std::make_unique<BytesInMemory>(file.text(array.offset, file.size()));
    if (array.open) stream_->next(array.offset);
  }

  // The next kSide planes, or what is left of them.
  void next_layer() {
    begin_ += layer_;
    layer_ = std::min(kSide, planes_ - read_) * plane_;
    read_ += layer_ / plane_;
    bytes_ = stream_->next(sizeof(Sample) * static_cast<std::uint64_t>(layer_ * width_)).data();
  }
  // After the last layer: the numbers of the next component follow, of planar arrays.
  void next_component() { read_ = begin_ = layer_ = 0; }
  void finish() { stream_->finish(); }

  // The tile whose first sample is `first`, x fastest; `absent` where the grid ends. It lies in the layer.
  void read(Size3 first, Sample absent, std::array<Sample, DistanceField::kTileSamples>& tile) const {
    tile.fill(absent);
    read_into(first, tile.data(), 1);
  }
  // The samples of the grid alone, each some numbers after the last.
  void read_into(Size3 first, Sample* tile, std::int64_t between) const {
    const std::int64_t nx = std::min(kSide, size_.x - first.x), ny = std::min(kSide, size_.y - first.y),
                       nz = std::min(kSide, size_.z - first.z);
    for (std::int64_t z = 0; z < nz; ++z)
      for (std::int64_t y = 0; y < ny; ++y) {
        const std::int64_t from = first.x * step_.x + (first.y + y) * step_.y + (first.z + z) * step_.z - begin_;
        Sample* row = tile + between * kSide * (y + kSide * z);
        for (std::int64_t x = 0; x < nx; ++x)
          for (std::int64_t c = 0; c < width_; ++c) row[between * x + c] = number((from + x * step_.x) * width_ + c);
      }
  }

 private:
  static constexpr std::int64_t kSide = DistanceField::kTileSide;

  Sample number(std::int64_t at) const {
    if constexpr (sizeof(Sample) == 1) {
      return static_cast<Sample>(bytes_[at]);
    } else {
      std::uint32_t bits;
      std::memcpy(&bits, bytes_ + sizeof bits * static_cast<std::uint64_t>(at), sizeof bits);
      return std::bit_cast<Sample>(swapped_ ? __builtin_bswap32(bits) : bits);
    }
  }

  std::unique_ptr<ByteStream> stream_;
  bool swapped_;
  Size3 size_, step_;
  std::int64_t planes_, plane_;         // of the slowest axis, and samples in each
  std::int64_t width_;                  // numbers of a sample
  std::int64_t read_ = 0;               // planes up to the end of the layer
  std::int64_t begin_ = 0, layer_ = 0;  // of the layer: its first sample, and how many there are
  const char* bytes_ = nullptr;
};

}  // namespace standoff
