// SPDX-License-Identifier: Apache-2.0
// One mesh in every layout a caller may hold it in: all of standoff must see the same mesh, bit for bit.
#include "standoff/mesh_view.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "standoff/collision.h"
#include "standoff/compute.h"
#include "standoff/points.h"
#include "standoff/testing/emulation.h"
#include "standoff/verify.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

const Grid kViewGrid{{21, 18, 19}, {-5, -5, -5}, {0.5, 0.5, 0.5}};

// A mesh whose vertices are floats, so that all layouts hold the same numbers; some triangles are long.
Mesh float_mesh(unsigned seed) {
  Mesh mesh = testing::random_soup(seed, 120, 4, 1);
  testing::append(mesh, testing::random_soup(seed + 1, 4, 4, 15));
  for (Vec3& v : mesh.vertices) v = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  return mesh;
}

// Elements of three numbers of type T in a buffer of bytes, `stride` bytes apart and `offset` bytes behind the start.
// Between them lies what no reader may take for a number. Negative strides begin at the end.
template <class T>
struct Bytes {
  std::vector<std::byte> buffer;
  const T* first = nullptr;

  template <class Elements>
  Bytes(const Elements& elements, std::ptrdiff_t stride, std::size_t offset) {
    const auto step = static_cast<std::size_t>(std::abs(stride));
    buffer.assign(offset + step * elements.size() + 3 * sizeof(T), std::byte{0xee});
    std::byte* const start = buffer.data() + offset + (stride < 0 ? step * (elements.size() - 1) : 0);
    for (std::size_t n = 0; n < elements.size(); ++n) {
      const auto numbers = three_of(elements[n]);
      std::memcpy(start + static_cast<std::ptrdiff_t>(n) * stride, numbers.data(), sizeof numbers);
    }
    first = reinterpret_cast<const T*>(start);
  }
  static std::array<T, 3> three_of(const Vec3& v) {
    return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
  }
  static std::array<T, 3> three_of(const Triangle& t) {
    return {static_cast<T>(t[0]), static_cast<T>(t[1]), static_cast<T>(t[2])};
  }
};

template <class Real, class Index>
struct Held {
  Bytes<Real> vertices;
  Bytes<Index> triangles;
  MeshView view;

  Held(const Mesh& mesh, std::ptrdiff_t more, std::size_t offset, bool backwards)
      : vertices(mesh.vertices, stride_of<Real>(more, backwards), offset),
        triangles(mesh.triangles, stride_of<Index>(more, backwards), offset),
        view{{vertices.first, mesh.vertices.size(), stride_of<Real>(more, backwards)},
             {triangles.first, mesh.triangles.size(), stride_of<Index>(more, backwards)}} {}

  template <class T>
  static std::ptrdiff_t stride_of(std::ptrdiff_t more, bool backwards) {
    const auto stride = static_cast<std::ptrdiff_t>(3 * sizeof(T)) + more;
    return backwards ? -stride : stride;
  }
};

// Calls use(view, name) with the mesh in every layout.
template <class Real, class Index, class Use>
void in_strides(const Mesh& mesh, const std::string& types, Use use) {
  for (const std::ptrdiff_t more : {0, 8, 20, 1})  // packed, interleaved with normals or such, misaligned
    for (const std::size_t offset : {0, 3}) {
      const Held<Real, Index> held(mesh, more, offset, false);
      use(held.view, types + ", stride + " + std::to_string(more) + ", offset " + std::to_string(offset));
    }
  const Held<Real, Index> backwards(mesh, 4, 0, true);
  use(backwards.view, types + ", backwards");
}
template <class Real, class Use>
void in_indices(const Mesh& mesh, const std::string& real, Use use) {
  in_strides<Real, std::uint32_t>(mesh, real + " uint32", use);
  in_strides<Real, std::int32_t>(mesh, real + " int32", use);
  in_strides<Real, std::uint64_t>(mesh, real + " uint64", use);
  in_strides<Real, std::int64_t>(mesh, real + " int64", use);
}
template <class Use>
void in_every_layout(const Mesh& mesh, Use use) {
  in_indices<double>(mesh, "double", use);
  in_indices<float>(mesh, "float", use);
}

TEST(MeshView, OfVectorsAndSpansIsPacked) {
  const Mesh mesh = float_mesh(1);
  const MeshView view = mesh;
  EXPECT_EQ(view.vertices.as_span()->data(), mesh.vertices.data());
  EXPECT_EQ(view.triangles.as_span()->data(), mesh.triangles.data());
  EXPECT_EQ((MeshView{std::span(mesh.vertices).first(4), std::span(mesh.triangles).first(2)}.triangles.size()), 2u);
  EXPECT_TRUE(MeshView{}.triangles.empty());
}

TEST(MeshView, ElementsBoundsAndHashesAreThoseOfTheMesh) {
  const Mesh mesh = float_mesh(2);
  const Box box = bounds(mesh);
  const std::uint64_t hash = content_hash(mesh);
  in_every_layout(mesh, [&](const MeshView& view, const std::string& name) {
    SCOPED_TRACE(name);
    ASSERT_EQ(view.vertices.size(), mesh.vertices.size());
    ASSERT_EQ(view.triangles.size(), mesh.triangles.size());
    EXPECT_TRUE(std::equal(mesh.vertices.begin(), mesh.vertices.end(), view.vertices.begin()));
    EXPECT_TRUE(std::equal(mesh.triangles.begin(), mesh.triangles.end(), view.triangles.begin()));
    EXPECT_EQ(view.corner(7, 2), MeshView(mesh).corner(7, 2));
    EXPECT_EQ(view.corners(7), MeshView(mesh).corners(7));
    EXPECT_EQ(view.corners(7)[1], view.corner(7, 1));
    EXPECT_EQ(view.triangles.index(9, 1), mesh.triangles[9][1]);
    validate(view);
    EXPECT_EQ(bounds(view).min, box.min);
    EXPECT_EQ(bounds(view).max, box.max);
    EXPECT_EQ(content_hash(view), hash);
  });
}

TEST(MeshView, FieldsAreTheSameBits) {
  const Mesh mesh = float_mesh(3);
  for (const double thickness : {0.7, kFullField}) {
    const DistanceField expected = testing::computed(mesh, kViewGrid, thickness).field;
    in_every_layout(mesh, [&](const MeshView& view, const std::string& name) {
      SCOPED_TRACE(name);
      testing::expect_same_bits(testing::computed(view, kViewGrid, thickness).field, expected);
    });
  }
}

// Every way to compute, in a few layouts.
TEST(MeshView, EveryMethodAndInstructionSetReadsIt) {
  const Mesh mesh = float_mesh(4);
  const Held<float, std::int64_t> floats(mesh, 4, 0, false);
  const Held<double, std::uint32_t> loose(mesh, 4, 1, false);
  for (const MeshView& view : {floats.view, loose.view}) {
    for (const Simd simd : {Simd::portable, Simd::avx2, Simd::avx512})
      for (const double thickness : {0.7, kFullField}) try {
          testing::expect_same_bits(testing::computed(view, kViewGrid, thickness, simd).field,
                                    testing::computed(mesh, kViewGrid, thickness).field);
        } catch (const Error& error) {  // a set that this processor does not have
          EXPECT_EQ(error.code(), ErrorCode::usage);
        }
    for (const Method method : {Method::tiles, Method::thesis})
      for (const SkipRule::Kind kind : {SkipRule::Kind::none, SkipRule::Kind::neighbour, SkipRule::Kind::exact})
        for (const Backend backend : {Backend::cpu, testing::kEmulated}) {
          ComputeOptions options{
              .method = method, .skip = {.kind = kind}, .sign = {SignMethod::none}, .execution = {.backend = backend}};
          testing::expect_same_bits(compute(view, kViewGrid, 1, options).field,
                                    compute(mesh, kViewGrid, 1, options).field);
        }
  }
}

TEST(MeshView, BodiesAndPointsAnswerTheSame) {
  const Mesh mesh = float_mesh(5), other = testing::random_soup(6, 20, 1, 0.5);
  const Body expected(mesh), probe(other);
  const std::vector<Vec3> points{{1, 2, 3}, {-4, 0, 1}, {0, 0, 0}};
  const Held<float, std::uint64_t> held(mesh, 12, 0, false);
  const Body body(held.view);
  EXPECT_EQ(content_hash(body.mesh()), content_hash(mesh));
  const DistanceResult a = distance(expected, {}, probe, {}), b = distance(body, {}, probe, {});
  EXPECT_EQ(a.upper, b.upper);
  EXPECT_EQ(a.triangle_a, b.triangle_a);
  EXPECT_TRUE(verify(compute(mesh, kViewGrid, 1, {.sign = {SignMethod::none}}).field, held.view).ok());
  for (std::size_t n = 0; n < points.size(); ++n)
    EXPECT_EQ(closest_points(held.view, points)[n].point, closest_points(mesh, points)[n].point);
}

// Cut to 32 bits, 2^32 + 1 is vertex 1 and -1 the last that there may ever be.
template <class Index>
void expect_index_refused(Index bad, const std::string& told) {
  const std::vector<Vec3> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Index indices[] = {0, 1, 2, 2, bad, 0};
  const MeshView view{vertices, {indices, 2}};
  for (int way = 0; way < 3; ++way) try {
      if (way == 0) validate(view);
      if (way == 1) static_cast<void>(bounds(view));
      if (way == 2) compute(view, kViewGrid, 1, {.sign = {SignMethod::none}});
      ADD_FAILURE() << "no error for " << told;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_NE(std::string(error.what()).find("triangle 1: index " + told + " is out of range"), std::string::npos)
          << error.what();
      EXPECT_EQ(error.details().triangle, 1);
    }
  static_cast<void>(content_hash(view));
  expect_error([&] { Body{view}; }, ErrorCode::input, told);
  expect_error([&] { closest_points(view, vertices); }, ErrorCode::input, told);
}

TEST(MeshView, IndicesOutOfRangeAreRefusedAsTheyStand) {
  expect_index_refused<std::int32_t>(-1, "-1");
  expect_index_refused<std::int32_t>(-2, "-2");
  expect_index_refused<std::int64_t>(-1, "-1");
  expect_index_refused<std::int64_t>(std::int64_t{1} << 40, "1099511627776");
  expect_index_refused<std::uint64_t>((std::uint64_t{1} << 32) + 1, "4294967297");
  expect_index_refused<std::uint64_t>(~std::uint64_t{0}, "9223372036854775807");
  expect_index_refused<std::uint32_t>(3, "3");
}

TEST(MeshView, NullIsEmptyOrRefused) {
  const float* const none = nullptr;
  const std::int64_t* const no_index = nullptr;
  expect_error([&] { validate(MeshView{{none, 0}, {no_index, 0}}); }, ErrorCode::input, "no triangles");
  expect_error([&] { validate(MeshView{{none, 3}, std::vector<Triangle>{{0, 1, 2}}}); }, ErrorCode::usage, "null");
  expect_error([&] { validate(MeshView{{none, 0}, {no_index, 1}}); }, ErrorCode::usage, "null");
  EXPECT_TRUE(bounds(MeshView{{none, 0}, {no_index, 0}}).empty());
  EXPECT_EQ(content_hash(MeshView{{none, 0}, {no_index, 0}}), content_hash(Mesh{}));
}

}  // namespace
}  // namespace standoff
