// SPDX-License-Identifier: Apache-2.0
// Arguments that make no sense, and what a public function may do with them: answer, or throw an Error that says what
// to do next. Nothing else: no other exception, no crash, no endless work.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <exception>
#include <limits>
#include <string>
#include <vector>

#include "standoff/error.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/pose.h"

namespace standoff::testing {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinite = std::numeric_limits<double>::infinity();
inline constexpr std::array kNumbers{kNaN, kInfinite, -kInfinite, 0.0,    -0.0,
                                     -1.0, 1.0,       1e308,      -1e308, std::numeric_limits<double>::denorm_min()};
inline constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
inline constexpr std::array<std::int64_t, 9> kCounts{std::numeric_limits<std::int64_t>::min(),
                                                     -1,
                                                     0,
                                                     1,
                                                     2,
                                                     std::int64_t{1} << 32,
                                                     std::int64_t{1} << 40,
                                                     std::int64_t{1} << 62,
                                                     kMost};
inline constexpr std::array kThreads{std::numeric_limits<int>::min(), -1, 1025, 1'000'000,
                                     std::numeric_limits<int>::max()};

template <class Call>
void expect_answer_or_error(const std::string& what, Call call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_NE(error.code(), ErrorCode::internal) << what << ": " << error.what();
    const std::string text = error.what();
    EXPECT_NE(text.find("; "), text.npos) << what << " says not what to do: " << text;
  } catch (const std::exception& error) {
    ADD_FAILURE() << what << " throws what is no Error: " << error.what();
  } catch (...) {
    ADD_FAILURE() << what << " throws what is no Error";
  }
}

template <class Call>
void expect_usage(const std::string& what, Call call) {
  try {
    call();
    ADD_FAILURE() << what << ": no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage) << what << ": " << error.what();
  }
}

/// Names a case: "thickness -1".
template <class Value>
std::string named(const char* what, Value value) {
  return std::string(what) + " " + std::to_string(value);
}

/// A number that is none of an enumeration's.
template <class Enum>
Enum none_of() {
  return static_cast<Enum>(77);
}

inline Mesh one_triangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}; }

/// Meshes that cannot be used.
inline std::vector<Mesh> unusable_meshes() {
  Mesh not_finite = one_triangle(), infinite = one_triangle(), out_of_range = one_triangle(),
       no_vertices = one_triangle();
  not_finite.vertices[1].y = kNaN;
  infinite.vertices[2].z = kInfinite;
  out_of_range.triangles[0][2] = 3;
  no_vertices.vertices.clear();
  return {{}, not_finite, infinite, out_of_range, no_vertices};
}

/// And some at the edge of what can be.
inline std::vector<Mesh> odd_meshes() {
  std::vector<Mesh> meshes = unusable_meshes();
  for (const double size : {1e-300, 1e-15, 1e15, 1e300}) {
    Mesh mesh = one_triangle();
    for (Vec3& v : mesh.vertices) v = v * size;
    meshes.push_back(mesh);
  }
  meshes.push_back({{{1, 1, 1}}, {{0, 0, 0}}});
  return meshes;
}

/// No rotations, and poses whose numbers are none.
inline std::vector<Pose> odd_poses() {
  std::vector<Pose> poses;
  for (const double x : kNumbers)
    for (const int entry : {0, 5, 9, 11}) {
      Pose pose;
      if (entry < 9)
        pose.rotation[static_cast<std::size_t>(entry)] = x;
      else
        (entry == 9 ? pose.translation.x : pose.translation.z) = x;
      poses.push_back(pose);
    }
  Pose mirror, zero;
  mirror.rotation[0] = -1;
  zero.rotation = {};
  poses.insert(poses.end(), {mirror, zero});
  return poses;
}

/// No grids, and grids that no memory holds: more than 2^31 tiles of 512 samples.
inline std::vector<Grid> odd_grids() {
  std::vector<Grid> grids;
  for (const std::int64_t n : kCounts)
    if (n < 1 || n > 2) {
      grids.push_back({{n, n, n}, {}});
      grids.push_back({{2, 2, 2}, {}, {1, 1, 1}, {0, n, 0}});
      if (n < 1 || n > std::int64_t{1} << 34) {
        grids.push_back({{n, 1, 1}, {}});
        grids.push_back({{1, 2, n}, {}});
      }
    }
  for (const double x : kNumbers) {
    grids.push_back({{2, 2, 2}, {x, 0, 0}});
    grids.push_back({{2, 2, 2}, {}, {1, x, 1}});
    grids.push_back({{2, 2, 2}, {}, {x, x, x}});
  }
  return grids;
}

}  // namespace standoff::testing
