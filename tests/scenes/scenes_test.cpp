// SPDX-License-Identifier: Apache-2.0
// The table of scenes: counts, extents, any size on request, the same bits everywhere.
#include "scenes/scenes.h"

#include <gtest/gtest.h>

#include <set>

#include "standoff/error.h"
#include "tests/scenes/topology.h"

namespace standoff {
namespace {

struct Expected {
  const char* name;
  std::int64_t triangles;
  Vec3 extent;         // world units; zero where any will do
  std::uint64_t hash;  // content_hash of the scene at its own count
};

// The hashes pin every coordinate and index to the last bit. A change of a scene changes its hash: look at a picture of
// it, then write the new one down. A hash that differs between machines or compilers is a bug.
const Expected kExpected[] = {
    {"factory", 2889536, {10.6, 2.8, 12.7}, 0xca749124b4b9c89c},
    {"machine_1", 481888, {6.4, 5.4, 22.95}, 0xad391d8719764b85},
    {"machine_2", 1444768, {6.35, 5.4, 22.95}, 0x253912521345c571},
    {"our_process", 65356, {6.1, 2.55, 21.1}, 0x26d42db5bf223a0c},
    {"our_process_small", 74745, {6.1, 16.4, 21.15}, 0xa1742c8f1214af3a},
    {"our_process_large", 16599, {7.75, 4.6, 21.1}, 0x52e68533b3242fc5},
    {"plane", 58421, {11.8, 1.9, 6.9}, 0x37ea3be6bcea7cda},
    {"bender", 12034, {7.7, 5.8, 1.9}, 0xdd9a86560cf8ff4d},
    {"catapult", 9618, {4.9, 3.9, 2.9}, 0x0d0d033b2c014059},
    {"process", 8100, {0.4, 0.46666, 0.16666}, 0x5543de173e0d17f2},
    {"labyrinth", 217000, {140.8, 9.75, 136.2}, 0xedbe348bbe657e68},
    {"fly", 6500, {3.2, 1.8, 3}, 0xf59f6f2b1524736b},
    {"sphere", 20000, {2, 2, 2}, 0x26db17dc04cd6d97},
    {"box", 12, {2, 1.5, 1}, 0xefb941dadbf7a07d},
    {"terrain", 200000, {}, 0xdcf68a825ce621f5},
    {"slivers", 20000, {}, 0xe6106106ea954a00},
    {"degenerate", 20000, {}, 0xbeb58f4d0581c6ff},
    {"duplicate", 20000, {}, 0x321debc55fa6713a},
    {"soup", 20000, {}, 0x44a68c36f324362e},
    {"nested", 19200, {}, 0xde4bfc728b9ca204},
    {"open", 20000, {}, 0xc748f9030f2e5a81},
    {"one_triangle", 1, {3, 2, 1.5}, 0x4e6144a70ed37ca9},
    {"far_away", 6500, {}, 0xa6bbb3f1c0df1729},
    {"tiny", 6500, {}, 0xd611eb3920d83b55},
};

void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.name; }

class EveryScene : public testing::TestWithParam<Expected> {};

TEST_P(EveryScene, HasItsCountExtentAndBits) {
  const Expected& expected = GetParam();
  const Mesh mesh = scenes::make(expected.name);
  ASSERT_NO_THROW(validate(mesh));
  EXPECT_EQ(static_cast<std::int64_t>(mesh.triangles.size()), expected.triangles);
  const Vec3 extent = bounds(mesh).extent();
  if (!(expected.extent == Vec3{})) {
    EXPECT_NEAR(extent.x, expected.extent.x, 1e-9 * expected.extent.x);
    EXPECT_NEAR(extent.y, expected.extent.y, 1e-9 * expected.extent.y);
    EXPECT_NEAR(extent.z, expected.extent.z, 1e-9 * expected.extent.z);
  }
  EXPECT_EQ(content_hash(mesh), expected.hash) << "0x" << std::hex << content_hash(mesh);
}

TEST_P(EveryScene, ComesInOtherSizes) {
  const Expected& expected = GetParam();
  for (const std::int64_t wanted : {1, 50, 3000, 30001}) {
    const Mesh mesh = scenes::make(expected.name, wanted);
    ASSERT_NO_THROW(validate(mesh)) << wanted;
    const auto count = static_cast<std::int64_t>(mesh.triangles.size());
    // Some constructions have a smallest size, and steps: 8 n^2 for a sphere, six such for the nested ones.
    EXPECT_LE(count, std::max<std::int64_t>(wanted + wanted / 10, 3000)) << wanted;
    if (wanted >= 3000) {
      EXPECT_GE(count, wanted - wanted / 4) << wanted;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, EveryScene, testing::ValuesIn(kExpected),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Scenes, AllAreExpectedAndDescribed) {
  std::set<std::string> names;
  for (const scenes::Scene& scene : scenes::all()) {
    EXPECT_TRUE(names.insert(scene.name).second) << scene.name;
    EXPECT_FALSE(scene.description.empty()) << scene.name;
    const auto* expected = std::find_if(std::begin(kExpected), std::end(kExpected),
                                        [&](const Expected& e) { return scene.name == e.name; });
    ASSERT_NE(expected, std::end(kExpected)) << scene.name;
    EXPECT_EQ(scene.triangles, expected->triangles) << scene.name;
  }
  EXPECT_EQ(names.size(), std::size(kExpected));
}

TEST(Scenes, UnknownNameIsAUsageErrorThatListsTheKnown) {
  try {
    scenes::make("no_such_scene");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("no_such_scene"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("labyrinth"), std::string::npos);
  }
}

TEST(Scenes, CountsOutOfRangeAreUsageErrors) {
  for (const std::int64_t count : {std::int64_t{-1}, std::int64_t{1} << 40}) {
    try {
      scenes::make("terrain", count);
      FAIL() << count;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
    }
  }
}

TEST(Scenes, TerrainAndFactoryHitAnyLargeCountExactly) {
  for (const char* name : {"terrain", "factory"})
    for (const std::int64_t wanted : {10000, 123456, 400000})
      EXPECT_EQ(static_cast<std::int64_t>(scenes::make(name, wanted).triangles.size()), wanted) << name;
}

TEST(Scenes, SphereLiesOnTheUnitSphere) {
  const Mesh mesh = scenes::make("sphere");
  for (const Vec3 v : mesh.vertices) ASSERT_NEAR(length(v), 1, 1e-15);
}

TEST(Scenes, FarAwayAndTinyAreTheFly) {
  const Mesh fly = scenes::make("fly"), far_away = scenes::make("far_away"), tiny = scenes::make("tiny");
  ASSERT_EQ(fly.triangles, far_away.triangles);
  ASSERT_EQ(fly.triangles, tiny.triangles);
  EXPECT_GT(bounds(far_away).min.x, 999990);
  EXPECT_LT(bounds(tiny).max.x, 4e-6);
}

TEST(Scenes, NastyOnesAreNasty) {
  EXPECT_GT(flat_triangles(scenes::make("degenerate")), 6600);  // the collinear ones are flat but for rounding
  EXPECT_GT(unmatched_edges(scenes::make("open")), 4000);
  const auto nested = part_volumes(scenes::make("nested"));
  EXPECT_EQ(std::count_if(nested.begin(), nested.end(), [](double v) { return v < 0; }), 2);
  const Mesh soup = scenes::make("soup");
  EXPECT_EQ(soup.vertices.size(), 3 * soup.triangles.size());
}

}  // namespace
}  // namespace standoff
