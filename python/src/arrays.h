// SPDX-License-Identifier: Apache-2.0
// Arrays in, without a copy: views of numpy's memory. Arrays out: memory that numpy frees.
//
// standoff/_arrays.py converts what users pass, with checks; so what arrives here has the right shape, type and order,
// or there is a bug there, which the types below turn into a TypeError.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "common.h"
#include "standoff/mesh_view.h"
#include "standoff/pose.h"
#include "standoff/vec.h"

namespace standoff::python {

/// Vertices, float32 or float64, and faces, of 32 or 64 bits. Rows may be apart, but the three numbers of one are not.
using VertexInput = nb::ndarray<nb::ro, nb::shape<-1, 3>, nb::device::cpu>;
using FaceInput = nb::ndarray<nb::ro, nb::shape<-1, 3>, nb::device::cpu>;
/// Points and other vectors, (n, 3) doubles in C order.
using PointInput = nb::ndarray<nb::ro, const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
/// Rotations and translations of poses, (n, 12) doubles in C order: nine row by row, then three.
using PoseInput = nb::ndarray<nb::ro, const double, nb::shape<-1, 12>, nb::c_contig, nb::device::cpu>;

/// Throws TypeError if the types or strides do not fit.
MeshView view_of(const VertexInput& vertices, const FaceInput& faces);

inline std::span<const Vec3> points_of(const PointInput& points) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return {reinterpret_cast<const Vec3*>(points.data()), points.shape(0)};
}
/// The n-th pose.
Pose pose_of(const PoseInput& poses, std::size_t n);
/// All of them. Errors: usage (a pose that is not rigid; batches would number it within a part).
std::vector<Pose> poses_of(const PoseInput& poses);

/// An array of numpy's, as a type that stubs name.
template <class Number>
using Array = nb::ndarray<nb::numpy, Number>;

/// A new array of numpy's, in C order, whose memory is not initialised.
template <class Number>
struct NewArray {
  explicit NewArray(std::vector<std::size_t> shape) : shape_(std::move(shape)), memory_(new Number[count()]) {}

  std::size_t count() const {
    std::size_t n = 1;
    for (const std::size_t side : shape_) n *= side;
    return n;
  }
  Number* data() { return memory_.get(); }
  Number& operator[](std::size_t n) { return memory_[n]; }
  /// Hands the memory over.
  Array<Number> finish() {
    const nb::capsule owner(memory_.get(), [](void* p) noexcept { delete[] static_cast<Number*>(p); });
    Number* const data = memory_.release();
    return {data, shape_.size(), shape_.data(), owner};
  }

 private:
  std::vector<std::size_t> shape_;
  std::unique_ptr<Number[]> memory_;
};

/// An array over the elements of a vector, which it keeps: (n, 3) for elements of three numbers.
template <class Number, class Element>
Array<Number> array_over(std::vector<Element>&& elements) {
  constexpr std::size_t kNumbers = sizeof(Element) / sizeof(Number);
  static_assert(kNumbers * sizeof(Number) == sizeof(Element));
  auto* const kept = new std::vector<Element>(std::move(elements));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<Element>*>(p); });
  const std::size_t shape[2] = {kept->size(), kNumbers};
  auto* const data = reinterpret_cast<Number*>(kept->data());
  return {data, kNumbers == 1 ? 1 : 2, shape, owner};
}

}  // namespace standoff::python
