// SPDX-License-Identifier: Apache-2.0
// Views of the caller's vertices and triangles, in any layout, without a copy.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "standoff/vec.h"

namespace standoff {

/// Three indices into the vertices of a mesh.
using Triangle = std::array<std::uint32_t, 3>;

namespace detail {

/// The number in memory at `from`, which need not be aligned. Vertices are read number by number with it: compilers
/// copy 24 bytes through the stack, which made binning a fine mesh's triangles a third slower.
template <class Number>
Number load(const std::byte* from) {
  Number value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

template <class Number>
Vec3 load_vertex(const std::byte* from) {
  return {load<Number>(from), load<Number>(from + sizeof(Number)), load<Number>(from + 2 * sizeof(Number))};
}

}  // namespace detail

/// Iterates over the elements of an array.
template <class Array>
class ElementIterator {
 public:
  using difference_type = std::ptrdiff_t;
  using value_type = std::remove_cvref_t<decltype(std::declval<const Array&>()[0])>;
  using pointer = const value_type*;
  using reference = value_type;
  using iterator_category = std::input_iterator_tag;

  ElementIterator() = default;
  ElementIterator(const Array& array, std::size_t n) : array_(&array), n_(n) {}
  value_type operator*() const { return (*array_)[n_]; }
  ElementIterator& operator++() {
    ++n_;
    return *this;
  }
  ElementIterator operator++(int) { return {*array_, n_++}; }
  friend bool operator==(const ElementIterator& a, const ElementIterator& b) { return a.n_ == b.n_; }

 private:
  const Array* array_ = nullptr;
  std::size_t n_ = 0;
};

/// A view of vertices in the caller's memory. A vertex is three adjacent numbers; the next vertex begins `stride` bytes
/// later. The stride may have any size and sign. Numbers need not be aligned. Floats are converted to double exactly.
class VertexArray {
 public:
  enum class Type : std::uint8_t { float64, float32 };

  VertexArray() = default;
  VertexArray(std::span<const Vec3> vertices)
      : VertexArray(reinterpret_cast<const double*>(vertices.data()), vertices.size()) {}
  template <class Range>
  requires std::convertible_to<const Range&, std::span<const Vec3>> VertexArray(const Range& vertices)
      : VertexArray(std::span<const Vec3>(vertices)) {}
  /// `first` is the x of the first vertex; it may be null if there are no vertices.
  VertexArray(const double* first, std::size_t count, std::ptrdiff_t stride = 3 * sizeof(double))
      : data_(reinterpret_cast<const std::byte*>(first)),
        count_(count),
        stride_(stride),
        packed_(stride == std::ptrdiff_t{sizeof(Vec3)}) {}
  VertexArray(const float* first, std::size_t count, std::ptrdiff_t stride = 3 * sizeof(float))
      : data_(reinterpret_cast<const std::byte*>(first)),
        count_(count),
        stride_(stride),
        type_(Type::float32),
        packed_(false) {}

  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  /// Requires n < size().
  Vec3 operator[](std::size_t n) const {
    if (packed_) return detail::load_vertex<double>(data_ + n * sizeof(Vec3));
    const std::byte* const at = data_ + static_cast<std::ptrdiff_t>(n) * stride_;
    return type_ == Type::float32 ? detail::load_vertex<float>(at) : detail::load_vertex<double>(at);
  }

  ElementIterator<VertexArray> begin() const { return {*this, 0}; }
  ElementIterator<VertexArray> end() const { return {*this, count_}; }

  const std::byte* data() const { return data_; }
  std::ptrdiff_t stride() const { return stride_; }
  Type type() const { return type_; }
  /// Whether the vertices are doubles without gaps between them.
  bool packed() const { return packed_; }
  /// The vertices as a span if they are packed and aligned; else nullopt.
  std::optional<std::span<const Vec3>> as_span() const {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    const bool aligned = reinterpret_cast<std::uintptr_t>(data_) % alignof(Vec3) == 0;
    if (!packed_ || !aligned) return std::nullopt;
    return std::span(reinterpret_cast<const Vec3*>(data_), count_);
  }

 private:
  const std::byte* data_ = nullptr;
  std::size_t count_ = 0;
  std::ptrdiff_t stride_ = sizeof(Vec3);
  Type type_ = Type::float64;
  bool packed_ = true;  // doubles without gaps: most meshes, and the fastest to read
};

/// A view of triangles in the caller's memory. A triangle is three adjacent indices; strides are as in VertexArray.
class TriangleArray {
 public:
  enum class Type : std::uint8_t { uint32, int32, uint64, int64 };
  /// The value of every index that does not fit into 32 bits. No vertex has this index, because validate() rejects
  /// meshes with so many vertices.
  static constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

  TriangleArray() = default;
  TriangleArray(std::span<const Triangle> triangles)
      : TriangleArray(reinterpret_cast<const std::uint32_t*>(triangles.data()), triangles.size()) {}
  template <class Range>
  requires std::convertible_to<const Range&, std::span<const Triangle>> TriangleArray(const Range& triangles)
      : TriangleArray(std::span<const Triangle>(triangles)) {}
  /// `first` is the first index of the first triangle; it may be null if there are no triangles.
  template <std::integral Index>
  requires(sizeof(Index) == 4 || sizeof(Index) == 8)
      TriangleArray(const Index* first, std::size_t count, std::ptrdiff_t stride = 3 * sizeof(Index))
      : data_(reinterpret_cast<const std::byte*>(first)),
        count_(count),
        stride_(stride),
        type_(sizeof(Index) == 4            ? std::signed_integral<Index> ? Type::int32 : Type::uint32
              : std::signed_integral<Index> ? Type::int64
                                            : Type::uint64),
        packed_(type_ == Type::uint32 && stride == std::ptrdiff_t{sizeof(Triangle)}) {}

  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  /// The three indices; kNoVertex replaces those that are negative or too large. Requires n < size().
  Triangle operator[](std::size_t n) const {
    const std::byte* const at = data_ + static_cast<std::ptrdiff_t>(n) * stride_;
    if (type_ == Type::uint32)
      return {detail::load<std::uint32_t>(at), detail::load<std::uint32_t>(at + 4),
              detail::load<std::uint32_t>(at + 8)};
    const auto fitting = [&](int k) {
      const std::int64_t v = index(n, k);
      return v >= 0 && v < kNoVertex ? static_cast<std::uint32_t>(v) : kNoVertex;
    };
    return {fitting(0), fitting(1), fitting(2)};
  }
  /// Index k of triangle n as it is in memory, but at most 2^63 - 1. Requires n < size(), and k in 0 to 2.
  std::int64_t index(std::size_t n, int k) const {
    const std::byte* const at = data_ + static_cast<std::ptrdiff_t>(n) * stride_ + k * index_bytes();
    constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
    switch (type_) {
      case Type::uint32:
        return detail::load<std::uint32_t>(at);
      case Type::int32:
        return detail::load<std::int32_t>(at);
      case Type::int64:
        return detail::load<std::int64_t>(at);
      case Type::uint64:
        return static_cast<std::int64_t>(std::min(detail::load<std::uint64_t>(at), kMost));
    }
    return -1;
  }

  ElementIterator<TriangleArray> begin() const { return {*this, 0}; }
  ElementIterator<TriangleArray> end() const { return {*this, count_}; }

  const std::byte* data() const { return data_; }
  std::ptrdiff_t stride() const { return stride_; }
  Type type() const { return type_; }
  /// Whether the indices are unsigned, have 32 bits, and have no gaps between triangles.
  bool packed() const { return packed_; }
  int index_bytes() const { return type_ == Type::uint32 || type_ == Type::int32 ? 4 : 8; }
  /// The triangles as a span if they are packed and aligned; else nullopt.
  std::optional<std::span<const Triangle>> as_span() const {
    static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
    const bool aligned = reinterpret_cast<std::uintptr_t>(data_) % alignof(Triangle) == 0;
    if (!packed_ || !aligned) return std::nullopt;
    return std::span(reinterpret_cast<const Triangle*>(data_), count_);
  }

 private:
  const std::byte* data_ = nullptr;
  std::size_t count_ = 0;
  std::ptrdiff_t stride_ = sizeof(Triangle);
  Type type_ = Type::uint32;
  bool packed_ = true;  // 32 bits, unsigned, without gaps
};

/// A view of the caller's mesh. Open, nonmanifold, self-intersecting and unoriented meshes, degenerate and duplicate
/// triangles are valid; NaN or infinite vertices and indices out of range are not. The layout changes no bit of any
/// result. The arrays must outlive the view.
///
///     MeshView view{{points.data(), points.size() / 3}, {faces.data(), faces.size() / 3}};
struct MeshView {
  VertexArray vertices;
  TriangleArray triangles;

  /// Corner k of a triangle. Requires a triangle of a valid mesh, and k in 0 to 2.
  Vec3 corner(std::size_t triangle, int k) const {
    if (!triangles.packed()) return vertices[static_cast<std::size_t>(triangles.index(triangle, k))];
    const std::byte* const first = triangles.data() + triangle * sizeof(Triangle);
    return vertices[detail::load<std::uint32_t>(first + sizeof(std::uint32_t) * static_cast<std::size_t>(k))];
  }

  /// The three corners of a triangle of a valid mesh. Faster than corner() three times.
  std::array<Vec3, 3> corners(std::size_t triangle) const {
    if (!triangles.packed() || !vertices.packed()) return corners_with_gaps(triangle);
    const std::byte* const first = triangles.data() + triangle * sizeof(Triangle);
    const auto at = [&](std::size_t k) {
      const auto vertex = detail::load<std::uint32_t>(first + sizeof(std::uint32_t) * k);
      return detail::load_vertex<double>(vertices.data() + vertex * sizeof(Vec3));
    };
    return {at(0), at(1), at(2)};
  }

 private:
  // Not inlined, so that corners() is.
  [[gnu::noinline]] std::array<Vec3, 3> corners_with_gaps(std::size_t triangle) const {
    return {corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
  }
};

}  // namespace standoff
