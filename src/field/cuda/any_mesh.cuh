// SPDX-License-Identifier: Apache-2.0
// Meshes in device memory in any layout: packs them for the kernels, and finds the boxes around them.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>

#include "field/cuda/bin.cuh"
#include "gpu/devices.h"
#include "standoff/grid.h"
#include "standoff/mesh_view.h"

namespace standoff::STANDOFF_PLATFORM {

/// Rows of three adjacent numbers in device memory, `stride` bytes apart.
struct Rows {
  const std::byte* first;
  std::int64_t count, stride;
};

/// Number n, counted through the rows.
template <class Number>
STANDOFF_DEVICE Number number_at(const Rows& rows, std::int64_t n) {
  return reinterpret_cast<const Number*>(rows.first + n / 3 * rows.stride)[n % 3];
}

/// Copies numbers, through which the threads stride.
template <class Number>
STANDOFF_KERNEL void pack_vertices(Rows rows, double* to) {
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < 3 * rows.count;
       n += std::int64_t{blockDim.x} * gridDim.x)
    to[n] = static_cast<double>(number_at<Number>(rows, n));
}

/// The same for indices. An index that is negative or does not fit into 32 bits becomes kNoVertex, which no vertex has.
template <class Index>
STANDOFF_KERNEL void pack_triangles(Rows rows, std::uint32_t* to) {
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < 3 * rows.count;
       n += std::int64_t{blockDim.x} * gridDim.x) {
    const Index index = number_at<Index>(rows, n);
    const auto value = static_cast<std::uint64_t>(index);  // large if the index is negative
    to[n] = value < TriangleArray::kNoVertex ? static_cast<std::uint32_t>(value) : TriangleArray::kNoVertex;
  }
}

/// The mesh in the layout of the kernels: in place if it is packed, else a copy in a workspace.
class PackedMesh {
 public:
  /// Takes room for copies. Throws Error{usage} for null pointers, numbers that are not aligned, and no or too many
  /// triangles.
  PackedMesh(const MeshView& view, gpu::Workspace& room)
      : vertices_(rows_of(view.vertices, view.vertices.type() == VertexArray::Type::float64 ? 8 : 4, "vertices")),
        triangles_(rows_of(view.triangles, view.triangles.index_bytes(), "indices")),
        vertex_type_(view.vertices.type()),
        index_type_(view.triangles.type()) {
    if (!view.vertices.packed()) vertex_copy_ = room.take<double>(3 * vertices_.count);
    if (!view.triangles.packed()) triangle_copy_ = room.take<std::uint32_t>(3 * triangles_.count);
    mesh_ = {vertex_copy_ ? vertex_copy_ : reinterpret_cast<const double*>(vertices_.first), vertices_.count,
             triangle_copy_ ? triangle_copy_ : reinterpret_cast<const std::uint32_t*>(triangles_.first),
             triangles_.count};
    check_count(mesh_);
    if (vertices_.count > std::int64_t{TriangleArray::kNoVertex})
      throw Error(ErrorCode::usage, "cuda: the mesh has more vertices than indices of 32 bits reach; split it");
  }

  /// Enqueues the copying, if any is needed.
  void pack(Stream stream) const {
    if (vertex_copy_) {
      const bool is_double = vertex_type_ == VertexArray::Type::float64;
      launch(stream, "pack vertices", is_double ? pack_vertices<double> : pack_vertices<float>, blocks(vertices_),
             kThreads, vertices_, vertex_copy_);
    }
    if (triangle_copy_) {
      using Type = TriangleArray::Type;
      const auto kernel = index_type_ == Type::uint32  ? pack_triangles<std::uint32_t>
                          : index_type_ == Type::int32 ? pack_triangles<std::int32_t>
                          : index_type_ == Type::int64 ? pack_triangles<std::int64_t>
                                                       : pack_triangles<std::uint64_t>;
      launch(stream, "pack triangles", kernel, blocks(triangles_), kThreads, triangles_, triangle_copy_);
    }
  }
  const DeviceMesh& mesh() const { return mesh_; }

 private:
  template <class Array>
  static Rows rows_of(const Array& array, std::int64_t number_bytes, const char* what) {
    if (!array.data() && array.size() > 0)
      throw Error(ErrorCode::usage, std::string("cuda: the ") + what + " are null; give device memory");
    if (reinterpret_cast<std::uintptr_t>(array.data()) % static_cast<std::uintptr_t>(number_bytes) != 0 ||
        array.stride() % number_bytes != 0)
      throw Error(ErrorCode::usage,
                  std::string("cuda: the ") + what + " in device memory are not aligned to the size of a number; copy");
    return {array.data(), static_cast<std::int64_t>(array.size()), array.stride()};
  }
  static std::int64_t blocks(const Rows& rows) {
    return std::min<std::int64_t>(kManyBlocks, 3 * rows.count / kThreads + 1);
  }

  Rows vertices_, triangles_;
  VertexArray::Type vertex_type_;
  TriangleArray::Type index_type_;
  double* vertex_copy_ = nullptr;  // also null while room is only measured
  std::uint32_t* triangle_copy_ = nullptr;
  DeviceMesh mesh_;
};

/// The least coordinates of all corners, and the complements of the greatest, as integers in the order of the doubles.
struct OrderedBounds {
  Counter low[3], high[3];
};

inline constexpr Counter kSignBit = Counter{1} << 63;
STANDOFF_DEVICE Counter ordered(double value) {
  const auto bits = static_cast<Counter>(__double_as_longlong(value));
  return bits & kSignBit ? ~bits : bits | kSignBit;
}
/// The double that this integer stands for.
inline double unordered(Counter number) {
  return std::bit_cast<double>(number & kSignBit ? number & ~kSignBit : ~number);
}
/// The plain read may be out of date; then the atomic minimum decides.
STANDOFF_DEVICE void lower(Counter* at, Counter value) {
  if (value < load_relaxed(at)) atomicMin(at, value);
}

/// Threads stride over the triangles. Invalid triangles are noted in the outcome.
STANDOFF_KERNEL void lower_bounds(DeviceMesh mesh, OrderedBounds* bounds, Outcome* outcome) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double low[3] = {kInfinity, kInfinity, kInfinity}, high[3] = {-kInfinity, -kInfinity, -kInfinity};
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < mesh.triangle_count;
       n += std::int64_t{blockDim.x} * gridDim.x) {
    const auto triangle = static_cast<std::uint32_t>(n);
    if (!is_valid(mesh, triangle, outcome)) continue;
    const Corners c = corners_of(mesh, triangle);
    for (const Triple<double>& corner : c.at) {
      const double at[3] = {corner.x, corner.y, corner.z};
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = min(low[axis], at[axis]);
        high[axis] = max(high[axis], at[axis]);
      }
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    lower(&bounds->low[axis], ordered(low[axis]));
    lower(&bounds->high[axis], ~ordered(high[axis]));
  }
}

/// The GPU's findings about a mesh and its field.
struct Found {
  OrderedBounds bounds;
  Outcome outcome;
};

/// Enqueues the search for the box around a mesh. Requires that the bytes of `found` are 0xff.
inline void find_box(const DeviceMesh& mesh, Found* found, Stream stream) {
  constexpr std::int64_t kMostBlocks = 512;  // few: each thread contends for the same six numbers
  launch(stream, "clear", clear_outcome, 1, 1, &found->outcome, static_cast<Counter*>(nullptr), 0);
  launch(stream, "bounds", lower_bounds, std::min(kMostBlocks, mesh.triangle_count / kThreads + 1), kThreads, mesh,
         &found->bounds, &found->outcome);
}

/// The box that was found. Throws Error{input} if a triangle is not valid.
inline Box box_of(const Found& found) {
  cuda::check(found.outcome, Task{});
  const OrderedBounds& b = found.bounds;
  return {{unordered(b.low[0]), unordered(b.low[1]), unordered(b.low[2])},
          {unordered(~b.high[0]), unordered(~b.high[1]), unordered(~b.high[2])}};
}

}  // namespace standoff::STANDOFF_PLATFORM
