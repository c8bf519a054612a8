// SPDX-License-Identifier: Apache-2.0
// Queries in files answer as before, bit by bit; damaged ones are errors, or answer without harm.
#include "points/query_file.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>

#include "files/atomic_file.h"
#include "scenes/scenes.h"
#include "sign/decision.h"
#include "standoff/error.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

std::vector<Vec3> points_around(MeshView mesh, int count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-0.75, 0.75);
  const Box box = bounds(mesh);
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n)
    points.push_back(box.center() + box.extent() * Vec3{unit(random), unit(random), unit(random)});
  return points;
}

std::vector<std::uint64_t> bits_of(const MeshQuery& query) {
  const std::vector<Vec3> points = points_around(query.mesh(), 300);
  std::vector<ClosestPoint> closest(points.size());
  query.closest(points, closest);
  std::vector<std::uint64_t> bits;
  for (const ClosestPoint& at : closest) {
    for (const double x : {at.distance, at.point.x, at.point.y, at.point.z, at.barycentric[0], at.barycentric[1]})
      bits.push_back(std::bit_cast<std::uint64_t>(x));
    bits.push_back(at.triangle * 16 + static_cast<std::uint64_t>(at.feature));
  }
  if (query.sign().method != SignMethod::winding) return bits;
  std::vector<double> windings(points.size());
  query.winding_numbers(points, windings);
  for (const double x : windings) bits.push_back(std::bit_cast<std::uint64_t>(x));
  return bits;
}

// A box that lacks some triangles and has a reversed one: it is open, and its orientation is repaired.
Mesh damaged_box() {
  Mesh mesh = scenes::make("sphere", 200);
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 3);
  std::swap(mesh.triangles[20][0], mesh.triangles[20][1]);
  return mesh;
}

// The second box is moved and smaller, so that it overlaps the first or lies inside it.
Mesh two_boxes(double scale, Vec3 by) {
  Mesh mesh = scenes::make("box");
  const Mesh other = mesh;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& v : other.vertices) mesh.vertices.push_back(v * scale + by);
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return mesh;
}

std::vector<std::pair<Mesh, SignOptions>> cases() {
  return {{scenes::make("fly"), {}},
          {scenes::make("box"), {.method = SignMethod::automatic}},
          {damaged_box(), {.method = SignMethod::winding}},
          {damaged_box(), {.method = SignMethod::winding, .as_oriented = true}},
          {damaged_box(), {.method = SignMethod::normal, .invert = true}},
          {two_boxes(1, {0.5, 0.3, 0.2}), {.method = SignMethod::parity}},
          {two_boxes(1, {0.5, 0.3, 0.2}), {.method = SignMethod::winding, .rule = WindingRule::odd}},
          {two_boxes(0.3, {}), {.method = SignMethod::winding, .outer = true}},
          {scenes::make("box"), {.method = SignMethod::shell, .shell = 0.1}}};
}

std::string bytes_of(const MeshQuery& query) {
  const TempFolder folder;
  query.save(folder / "a.query");
  return read_text(folder / "a.query");
}

TEST(QueryFile, AnswersAsBefore) {
  const TempFolder folder;
  for (const auto& [mesh, sign] : cases()) {
    SCOPED_TRACE(name_of(sign.method));
    const MeshQuery query(mesh, {.sign = sign});
    query.save(folder / "a.query");
    const MeshQuery again = MeshQuery::load(folder / "a.query");
    EXPECT_EQ(bits_of(again), bits_of(query));
    const SignReport &a = query.sign(), &b = again.sign();
    EXPECT_EQ(std::tie(a.method, a.why, a.sure, a.flipped, a.left_out, a.boundary_edges, a.internal, a.cut),
              std::tie(b.method, b.why, b.sure, b.flipped, b.left_out, b.boundary_edges, b.internal, b.cut));
    EXPECT_EQ(content_hash(again.mesh()), content_hash(query.mesh()));
    EXPECT_EQ(bytes_of(again), bytes_of(query));
  }
}

MeshQuery read(const std::string& bytes, ArrayChecksum checksum) {
  return read_query_file(FileView("damaged", bytes), checksum);
}

void expect_refused(const std::string& bytes, const std::string& words,
                    ArrayChecksum checksum = ArrayChecksum::ignored) {
  try {
    read(bytes, checksum);
    ADD_FAILURE() << "was read, expected " << words;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

template <class T>
std::string with(std::string bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

TEST(QueryFile, DamageIsFound) {
  const std::string good =
      bytes_of(MeshQuery(two_boxes(0.3, {}), {.sign = {.method = SignMethod::winding, .outer = true}}));
  for (std::size_t size = 0; size < good.size(); size += 1 + size / 40)
    expect_refused(good.substr(0, size), "damaged", ArrayChecksum::checked);
  expect_refused(good + "x", "its length is not what its header says");
  for (std::size_t at = 8; at < good.size(); at += 11) {
    std::string changed = good;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    expect_refused(changed, "damaged", ArrayChecksum::checked);
  }
  expect_refused(with(good, 0, 'x'), "this is no query that standoff saved");
  expect_refused(with(good, 8, 7u), "header: version 7 is not known");
  expect_refused(with(good, 16, ~std::uint64_t{}), "the file ends too early");
  expect_refused(with(good, 40, std::numeric_limits<double>::quiet_NaN()), "not finite");
  expect_refused(with(good, 40, 1e200), "it reaches beyond what is allowed");
  const std::size_t triangles = 40 + 16 * sizeof(Vec3), decision = triangles + 24 * sizeof(Triangle);
  expect_refused(with(good, triangles, 16u), "triangle 0");
  const std::size_t sign = decision + kSealBytes + 16;  // behind the hash and the number of triangles
  expect_refused(with(good, sign, std::uint8_t{99}), "a name is unknown");
  for (const int at : {0, 12})  // the method asked for, and the one found
    EXPECT_EQ(good[sign + static_cast<std::size_t>(at)], static_cast<char>(SignMethod::winding));
  const std::string flooded = with(with(good, sign, SignMethod::flood), sign + 12, SignMethod::flood);
  expect_refused(flooded, "none for points");
  expect_refused(with(good, sign + 4, 0.5), "shell");
  expect_refused(with(good, sign + 14, std::int64_t{-1}), "a count is negative");
}

// Any other change gives an error, or a query that answers.
TEST(QueryFile, OtherBytesDoNoHarm) {
  std::mt19937 random(5);
  for (const auto& [mesh, sign] : cases()) {
    if (mesh.triangles.size() > 1000) continue;
    const std::string good = bytes_of(MeshQuery(mesh, {.sign = sign}));
    for (int n = 0; n < 100; ++n) {
      std::string changed = good;
      for (int k = 0; k < 4; ++k)
        changed[random() % (k < 2 ? 40 : changed.size())] = static_cast<char>(random() % 5 - 2);
      changed.replace(0, 12, good, 0, 12);
      try {
        bits_of(read(changed, ArrayChecksum::ignored));
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace standoff
