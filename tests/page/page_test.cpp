// SPDX-License-Identifier: Apache-2.0
// What pages hold of meshes and fields, and that nothing in a name breaks out of a page.
#include "standoff/page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "page/page.h"
#include "scenes/scenes.h"
#include "standoff/compute.h"

namespace standoff {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vec3 placed(const page::LatticeMesh& mesh, std::uint32_t vertex) {
  const auto& at = mesh.vertices[vertex];
  return mesh.origin + Vec3{double(at[0]), double(at[1]), double(at[2])} * mesh.step;
}

// Triangle by triangle in the mesh's order, so that a field's nearest triangles are the page's.
TEST(Page, MeshIsTheSameWithinHalfAStep) {
  for (const double scale : {1.0, 1e-300, 1e140}) {
    Mesh mesh = scenes::make("bender");
    for (Vec3& v : mesh.vertices) v = v * scale + Vec3{1, 2, 3} * scale;
    mesh.vertices.push_back({1e200, 0, 0});  // which no triangle uses
    const page::LatticeMesh held = page::lattice_mesh(mesh, {});
    ASSERT_EQ(held.triangles.size(), mesh.triangles.size());
    EXPECT_LT(held.vertices.size(), mesh.vertices.size());
    PageItem item;
    page_data(PageMesh{"bender", mesh}, {}, &item);
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n)
      for (int k = 0; k < 3; ++k) {
        const Vec3 off = placed(held, held.triangles[n][k]) - mesh.vertices[mesh.triangles[n][k]];
        ASSERT_LE(max_norm(off), item.error * (1 + 1e-9)) << n;
      }
    EXPECT_LE(item.error, bounds(mesh).longest_side() / 65535);
  }
}

TEST(Page, SmallTrianglesGetAFinerLattice) {
  Mesh mesh = scenes::make("sphere", 200000);
  EXPECT_EQ(page::lattice_mesh(scenes::make("box"), {}).bits, 16);
  mesh.vertices.push_back({1000, 0, 0});
  mesh.vertices.push_back({1000, 1, 0});
  mesh.triangles.push_back(
      {0, static_cast<std::uint32_t>(mesh.vertices.size() - 2), static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
  EXPECT_EQ(page::lattice_mesh(mesh, {}).bits, 24);
}

TEST(Page, ManyTrianglesGetFewerBeside) {
  if (!page::can_simplify()) GTEST_SKIP() << "built without meshoptimizer";
  const Mesh mesh = scenes::make("sphere", 20000);
  const page::LatticeMesh held = page::lattice_mesh(mesh, {.proxy_triangles = 3000});
  EXPECT_EQ(held.triangles.size(), mesh.triangles.size());
  EXPECT_LE(held.proxy.size(), 2000u);
  EXPECT_GT(held.proxy.size(), 200u);
  EXPECT_TRUE(page::lattice_mesh(mesh, {.proxy_triangles = 100}).proxy.empty()) << "it would not look the same";
  EXPECT_GT(page::lattice_mesh(mesh, {.proxy_triangles = 100}, page::kAnyShape).proxy.size(), 10u);
  const page::LatticeMesh fewer = page::lattice_mesh(mesh, {.most_triangles = 5000, .proxy_triangles = 3000});
  EXPECT_TRUE(fewer.simplified);
  EXPECT_LE(fewer.triangles.size(), 5000u);
  EXPECT_LT(fewer.vertices.size(), 5000u);
  for (const auto& list : {fewer.triangles, fewer.proxy})
    for (const Triangle& t : list)
      for (const std::uint32_t index : t) ASSERT_LT(index, fewer.vertices.size());
}

double value_of(const page::CodedField& field, std::int64_t i, std::int64_t j, std::int64_t k) {
  const Size3 tiles = DistanceField::tiles_of(field.grid.size);
  const std::int64_t tile = i / 8 + tiles.x * (j / 8 + tiles.y * (k / 8));
  std::int64_t slot = 0;
  for (std::int64_t n = 0; n < tile; ++n) slot += field.tiles[static_cast<std::size_t>(n)] == 2;
  const char kind = field.tiles[static_cast<std::size_t>(tile)];
  if (kind != 2) return (kind == 1 ? -1 : 1) * field.clamped * field.step;
  const std::int32_t code = field.codes[static_cast<std::size_t>(512 * slot + i % 8 + 8 * (j % 8) + 64 * (k % 8))];
  if (code == page::kNoNumberCode) return std::nan("");
  if (std::abs(code) == page::kInfiniteCode) return code * kInfinity;
  return code * field.step;
}

TEST(Page, FieldIsTheSameWithinAStep) {
  const Mesh mesh = scenes::make("bender");
  for (const double thickness : {kInfinity, 0.07}) {
    ComputeOptions options{.sign = {.method = SignMethod::automatic}};
    const DistanceField field = compute(mesh, fit_resolution(bounds(mesh), 45, thickness), thickness, options).field;
    const page::CodedField held = page::coded_field(field, {});
    ASSERT_EQ(held.grid, field.grid());
    PageItem item;
    page_data(PageField{"bender", &field}, {}, &item);
    EXPECT_LT(item.error, field.grid().max_spacing() / 60);
    for (std::int64_t k = 0; k < field.grid().size.z; k += 3)
      for (std::int64_t j = 0; j < field.grid().size.y; ++j)
        for (std::int64_t i = 0; i < field.grid().size.x; ++i) {
          const float value = field.value(i, j, k);
          ASSERT_NEAR(value_of(held, i, j, k), value, item.error * (1 + 1e-6)) << i << " " << j << " " << k;
          // What is clamped is so in the page, and nothing else is.
          if (!std::isfinite(thickness)) continue;
          ASSERT_EQ(std::abs(value_of(held, i, j, k)) >= held.clamped * held.step, std::abs(value) >= float(thickness));
        }
  }
}

// For pages that wait for a field: what they unpack else is there as it is.
TEST(Page, WithoutCompressionValuesArePlain) {
  const Mesh mesh = scenes::make("bender");
  const DistanceField field =
      compute(mesh, fit_resolution(bounds(mesh), 20, 0.3), 0.3, {.sign = {SignMethod::none}}).field;
  const std::string bytes = page_data(PageField{"bender", &field}, {.compression = 0});
  const page::CodedField held = page::coded_field(field, {});
  ASSERT_EQ(bytes.substr(0, 4), "SOPG");
  ASSERT_GT(held.codes.size(), 0u);
  ASSERT_GT(bytes.size(), 2 * held.codes.size());
  for (std::size_t n = 0; n < held.codes.size(); ++n) {  // the last section
    const std::size_t at = bytes.size() - 2 * (held.codes.size() - n);
    const int low = static_cast<unsigned char>(bytes[at]), high = static_cast<signed char>(bytes[at + 1]);
    ASSERT_EQ(256 * high + low, held.codes[n]) << n;
  }
}

TEST(Page, LargeFieldsAreThinned) {
  const Mesh mesh = scenes::make("bender");
  const DistanceField field =
      compute(mesh, fit_resolution(bounds(mesh), 60), kFullField, {.sign = {SignMethod::none}}).field;
  const page::CodedField held = page::coded_field(field, {.most_samples = 20000});
  EXPECT_GT(held.every, 1);
  EXPECT_LE(held.grid.sample_count(), 20000);
  // Of a band, what is stored counts.
  const DistanceField band =
      compute(mesh, fit_resolution(bounds(mesh), 200, 0.05), 0.05, {.sign = {SignMethod::none}}).field;
  const page::CodedField all = page::coded_field(band, {.most_samples = band.stored_tiles() * 512});
  EXPECT_EQ(all.every, 1);
  EXPECT_GT(band.grid().sample_count(), band.stored_tiles() * 512);
  const page::CodedField some = page::coded_field(band, {.most_samples = band.stored_tiles() * 512 / 3});
  EXPECT_GT(some.every, 1);
  EXPECT_LE(std::min(some.stored * 512, some.grid.sample_count()), band.stored_tiles() * 512 / 3);
  for (std::int64_t n = 0; n < held.grid.size.x; ++n)
    EXPECT_NEAR(value_of(held, n, 2, 1), field.value(n * held.every, 2 * held.every, held.every), held.step);
}

TEST(Page, ValuesThatAreNoNumbers) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> values{0, 1, -2, inf, -inf, std::nanf(""), 3, 4};
  const DistanceField field = DistanceField::from_dense({{2, 2, 2}, {}, {1, 1, 1}}, kFullField, values);
  const page::CodedField held = page::coded_field(field, {});
  for (int n = 0; n < 8; ++n) {
    const double value = value_of(held, n & 1, n >> 1 & 1, n >> 2);
    if (std::isnan(values[n]))
      EXPECT_TRUE(std::isnan(value));
    else if (std::isinf(values[n]))
      EXPECT_EQ(value, values[n]);
    else
      EXPECT_NEAR(value, values[n], held.step);
  }
}

TEST(Page, TextForJson) {
  EXPECT_EQ(page::json_string("a\"b\\\n</script>&\xE2\x80\xA8"),
            "\"a\\u0022b\\u005c\\u000a\\u003c/script\\u003e\\u0026\\u2028\"");
  EXPECT_EQ(
      page::json_string("h\xC3\xA4\xFF\xC0\x80\xED\xA0\x80"), "\"h\xC3\xA4" + [] {
        std::string marks;
        for (int n = 0; n < 6; ++n) marks += "\xEF\xBF\xBD";
        return marks;
      }() + "\"");
  EXPECT_EQ(page::json_number(kInfinity), "null");
  EXPECT_EQ(page::json_number(0.1), "0.1");
}

TEST(Page, Base64) {
  for (const auto& [bytes, text] :
       {std::pair{"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}}) {
    std::string out;
    page::append_base64(out, bytes);
    EXPECT_EQ(out, text);
  }
}

TEST(Page, NamesStayNames) {
  const Mesh mesh = scenes::make("box");
  const std::string evil = "</script><img src=x onerror=alert(1)><!--@data-->";
  const std::vector<PageMesh> meshes{{evil, mesh}};
  const std::string page = make_page(meshes, {}, {.unit = evil});
  EXPECT_EQ(page.find("<img"), std::string::npos);
  EXPECT_EQ(page.find("onerror=alert(1)>"), std::string::npos);
  EXPECT_NE(page.find("&lt;img src=x onerror=alert(1)&gt;"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(page.find("connect-src"), std::string::npos);
  EXPECT_NE(make_page({}, {}, {.served = true}).find("connect-src 'self'"), std::string::npos);
}

TEST(Page, SameBytesEachTime) {
  const Mesh mesh = scenes::make("bender");
  EXPECT_EQ(page_data(PageMesh{"bender", mesh}), page_data(PageMesh{"bender", mesh}));
}

}  // namespace
}  // namespace standoff
