// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"

#include "standoff/error.h"

namespace standoff::python {
namespace {

template <class Array>
void expect_rows(const Array& array, const char* what) {
  if (array.shape(0) > 0 && array.stride(1) != 1)
    throw nb::type_error((std::string(what) + ": the three numbers of a row must be adjacent").c_str());
}

template <class Number>
VertexArray vertices_of(const VertexInput& array) {
  return {static_cast<const Number*>(array.data()), array.shape(0),
          static_cast<std::ptrdiff_t>(array.stride(0) * static_cast<std::int64_t>(sizeof(Number)))};
}

template <class Index>
TriangleArray triangles_of(const FaceInput& array) {
  return {static_cast<const Index*>(array.data()), array.shape(0),
          static_cast<std::ptrdiff_t>(array.stride(0) * static_cast<std::int64_t>(sizeof(Index)))};
}

VertexArray vertices_view(const VertexInput& array) {
  expect_rows(array, "vertices");
  if (array.dtype() == nb::dtype<double>()) return vertices_of<double>(array);
  if (array.dtype() == nb::dtype<float>()) return vertices_of<float>(array);
  throw nb::type_error("vertices: must be float32 or float64");
}

TriangleArray triangles_view(const FaceInput& array) {
  expect_rows(array, "faces");
  if (array.dtype() == nb::dtype<std::uint32_t>()) return triangles_of<std::uint32_t>(array);
  if (array.dtype() == nb::dtype<std::int32_t>()) return triangles_of<std::int32_t>(array);
  if (array.dtype() == nb::dtype<std::uint64_t>()) return triangles_of<std::uint64_t>(array);
  if (array.dtype() == nb::dtype<std::int64_t>()) return triangles_of<std::int64_t>(array);
  throw nb::type_error("faces: must be integers of 32 or 64 bits");
}

}  // namespace

MeshView view_of(const VertexInput& vertices, const FaceInput& faces) {
  return {vertices_view(vertices), triangles_view(faces)};
}

Pose pose_of(const PoseInput& poses, std::size_t n) {
  const double* const at = poses.data() + 12 * n;
  Pose pose;
  for (std::size_t k = 0; k < 9; ++k) pose.rotation[k] = at[k];
  pose.translation = {at[9], at[10], at[11]};
  return pose;
}

std::vector<Pose> poses_of(const PoseInput& poses) {
  std::vector<Pose> all(poses.shape(0));
  for (std::size_t n = 0; n < all.size(); ++n) {
    all[n] = pose_of(poses, n);
    try {
      validate(all[n]);
    } catch (const Error& error) {
      throw Error(error.code(), std::string(error.what()) + " (pose " + std::to_string(n) + ")");
    }
  }
  return all;
}

}  // namespace standoff::python
