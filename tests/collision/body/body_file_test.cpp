// SPDX-License-Identifier: Apache-2.0
// Bodies in files give the same answers; damaged or invented files give errors.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "collision/body/body.h"
#include "files/array_file.h"
#include "standoff/collision.h"
#include "tests/collision/solids.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

using namespace standoff::testing;

class BodyFile : public ::testing::Test {
 protected:
  TempFolder folder_;
  std::filesystem::path file_ = folder_.path() / "ball.body";
  static std::string bytes(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
  }
};

TEST_F(BodyFile, GivesTheSameAnswers) {
  const Body a(ball_mesh(1, 5)), b(random_soup(2, 50, 0.5, 0.3));
  a.save(file_);
  const Body loaded = Body::load(file_);
  EXPECT_EQ(loaded.memory_bytes(), a.memory_bytes());
  Random random(7);
  for (int n = 0; n < 100; ++n) {
    const Pose pose = random_pose(random, 1.5);
    const DistanceResult d = distance(a, {}, b, pose), e = distance(loaded, {}, b, pose);
    EXPECT_EQ(d.upper, e.upper);
    EXPECT_EQ(d.triangle_a, e.triangle_a);
  }
}

TEST_F(BodyFile, DamageIsAnError) {
  Body(solid_ball(1, 2), {.spacing = 0.3}).save(file_);
  const std::string good = bytes(file_);
  const auto code = [&] { return code_of([&] { Body::load(file_); }); };
  Random random(8);
  for (int n = 0; n < 300; ++n) {
    std::string bad = good;
    bad[random.below(static_cast<std::uint32_t>(n % 2 ? 72 : bad.size()))] ^= static_cast<char>(1 << random.below(8));
    if (bad == good) continue;
    write(file_, bad);
    EXPECT_EQ(code(), ErrorCode::input) << n;
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{7}, std::size_t{71}, good.size() / 2, good.size() - 1}) {
    write(file_, good.substr(0, length));
    EXPECT_EQ(code(), ErrorCode::input) << length;
  }
  write(file_, good + "x");
  EXPECT_EQ(code(), ErrorCode::input);
  EXPECT_EQ(code_of([&] { Body::load(folder_.path() / "none.body"); }), ErrorCode::input);
}

// Files of this version must stay readable.
TEST_F(BodyFile, FilesOfTheCorpusAreRead) {
  const std::filesystem::path folder = std::filesystem::path(kSourceFolder) / "tests/corpus/body";
  const Body box = Body::load(folder / "box.body");
  EXPECT_EQ(box.mesh().triangles.size(), 12u);
  EXPECT_TRUE(box.has_inside());
  EXPECT_NEAR(distance(box, {}, box, moved({3, 0, 0})).upper, 2, 1e-12);
  EXPECT_EQ(Body::load(folder / "triangle.body").mesh().triangles.size(), 1u);
  EXPECT_EQ(Body::load(folder / "strip.body").mesh().triangles.size(), 20u);
}

// Files with a new, matching checksum are checked all the same.
TEST_F(BodyFile, WhatCannotBeIsAnErrorWithoutTheChecksumToo) {
  Body(solid_ball(1, 2), {.spacing = 0.3}).save(file_);
  const std::string good = bytes(file_);
  std::uint64_t counts[5];
  std::memcpy(counts, good.data() + 16, sizeof counts);
  const std::size_t order = 72 + counts[0] * 24 + counts[1] * 12, slots = order + counts[1] * 4,
                    coarse = slots + counts[2] * 4 + counts[3], components = coarse + counts[4] * 4;
  ASSERT_EQ(good.size(), components + 4 + counts[3] / 8 + (counts[4] + 7) / 8 + 8);
  const auto message = [&](std::size_t at, auto value) {
    std::string bad = good;
    std::memcpy(bad.data() + at, &value, sizeof value);
    try {
      collision::read_body(FileView("x.body", bad), ArrayChecksum::ignored);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      return std::string(error.what());
    }
    return std::string("read");
  };
  const auto expect = [&](std::size_t at, auto value, const std::string& part) {
    EXPECT_NE(message(at, value).find(part), std::string::npos) << message(at, value);
  };
  EXPECT_EQ(message(8, std::uint32_t{2}), "read") << "the version it has";
  for (const std::uint32_t other : {1u, 3u})
    expect(8, other, "version " + std::to_string(other) + " is not known to this standoff, which knows 2; save the");
  expect(12, std::uint32_t{2}, "it is neither closed nor open");
  expect(12, std::uint32_t{0}, "its length is not what its header says");
  for (const std::uint64_t count : {std::uint64_t{0}, std::uint64_t{2}, ~std::uint64_t{0}})
    EXPECT_TRUE(message(64, count).starts_with("x.body:")) << count;
  expect(components, std::uint32_t(counts[1]), ":components: there are none, too many, or one without a triangle");
  for (int n = 0; n < 5; ++n)
    for (const std::uint64_t count : {std::uint64_t{0}, counts[n] + 1, counts[n] - 1, ~std::uint64_t{0}})
      EXPECT_TRUE(message(16 + 8 * n, count).starts_with("x.body:")) << n << " " << count;
  for (const double spacing : {0.0, -1.0, 1e-300, 1e-5, 0.2, 0.6, 1e300, std::nan(""), HUGE_VAL})
    EXPECT_TRUE(message(56, spacing).starts_with("x.body:") && message(56, spacing).ends_with("; save the body again"))
        << message(56, spacing);
  // The message once talked about a value that a caller may leave open.
  for (const double spacing : {0.0, -1.0, std::nan(""), HUGE_VAL})
    expect(56, spacing, ":header: its field's spacing is not positive and finite; save the body again");
  expect(72, std::nan(""), "vertex 0");
  expect(72, 1e16, "across; save the body again");
  expect(72 + counts[0] * 24, std::uint32_t(counts[0]), "triangle 0");
  expect(order, std::uint32_t(counts[1]), "its order names");
  std::uint32_t second;
  std::memcpy(&second, good.data() + order + 4, sizeof second);
  expect(order, second, "its order names a triangle twice");
  expect(slots, std::int32_t{-1}, "a tile's number is out of range");
  expect(slots, std::int32_t(counts[3] / 512), "a tile's number is out of range");
  expect(coarse, std::nanf(""), "a distance is not finite");
  expect(coarse, HUGE_VALF, "a distance is not finite");
  EXPECT_EQ(message(coarse, 1e30f), "read") << "wrong, but it cannot be known";
}

// Kernels compute sample indices in single precision, which has no halves past 2^23.
TEST_F(BodyFile, FieldsTooLongForSinglePrecisionAreAnError) {
  const auto plan = [](double length) { return collision::plan_field_bounds({{0, 0, 0}, {length, 1, 1}}, 1); };
  EXPECT_EQ(code_of([&] { plan(0x1p23); }), ErrorCode::limit);
  EXPECT_LT(plan(0x1p23 - 16).size.x, 1 << 23);
}

}  // namespace
}  // namespace standoff
