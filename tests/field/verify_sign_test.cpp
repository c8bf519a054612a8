// SPDX-License-Identifier: Apache-2.0
// verify and signs: right fields pass, each wrong sign is found, and signs that cannot be judged are counted as such.
#include <gtest/gtest.h>

#include <cmath>

#include "field/reference.h"
#include "standoff/compute.h"
#include "standoff/verify.h"
#include "tests/sign/solid_soup.h"

namespace standoff::testing {
namespace {

// Half of the solids below are inside out, and stay so.
const SignOptions kAsItIs{.method = SignMethod::winding, .as_oriented = true};
const Grid kSignGrid{{18, 17, 19}, {-2.1, -2, -2.2}, {0.23, 0.24, 0.225}};

DistanceField signed_field(const Mesh& mesh, const SignOptions& sign, double thickness = kFullField) {
  return compute(mesh, kSignGrid, thickness, {.sign = sign}).field;
}

VerifyResult verified(const DistanceField& field, const Mesh& mesh) {
  return verify(field, mesh, {.samples = kSignGrid.sample_count()});
}

// The field with values changed by change(value, index) and another provenance.
template <class Change>
DistanceField changed(const DistanceField& field, const std::string& sign, const Change& change) {
  std::vector<float> values = field.to_dense();
  for (std::size_t n = 0; n < values.size(); ++n) change(values[n], n);
  DistanceField result = DistanceField::from_dense(kSignGrid, field.thickness(), values);
  Provenance provenance = field.provenance();
  provenance.sign = sign;
  result.set_provenance(provenance);
  return result;
}
DistanceField renamed(const DistanceField& field, const std::string& sign) {
  return changed(field, sign, [](float&, std::size_t) {});
}

TEST(VerifySign, TrueSignsPass) {
  const Mesh mesh = solid_soup(1, 6);
  for (const SignOptions& sign : {kAsItIs,
                                  {.method = SignMethod::winding},
                                  {.method = SignMethod::winding, .rule = WindingRule::nonzero},
                                  {.method = SignMethod::winding, .rule = WindingRule::odd},
                                  {.method = SignMethod::winding, .invert = true},
                                  {.method = SignMethod::parity}})
    for (const double thickness : {0.15, kFullField}) {
      const VerifyResult found = verified(signed_field(mesh, sign, thickness), mesh);
      EXPECT_TRUE(found.ok()) << found.sign.method;
      EXPECT_TRUE(found.sign.can_check);
      EXPECT_EQ(found.sign.checked, kSignGrid.sample_count()) << found.sign.method;
      EXPECT_GT(found.sign.negative, 10) << found.sign.method;
    }
}

// No two rules agree on these solids, so a field that names the wrong one fails.
TEST(VerifySign, TheRuleIsTheFieldsOwn) {
  const Mesh mesh = solid_soup(1, 6);
  const DistanceField field = signed_field(mesh, kAsItIs);
  EXPECT_EQ(verified(renamed(field, "winding"), mesh).sign.wrong, 0);
  for (const char* other : {"winding nonzero", "winding odd", "parity", "winding inverted"}) {
    const VerifyResult found = verified(renamed(field, other), mesh);
    EXPECT_GT(found.sign.wrong, 0) << other;
    EXPECT_EQ(found.samples_wrong, 0) << other;
    EXPECT_FALSE(found.ok()) << other;
  }
}

TEST(VerifySign, EveryWrongSampleIsFound) {
  const Mesh mesh = solid_soup(2, 6);
  const DistanceField field = signed_field(mesh, kAsItIs);
  const auto wrong_at = [&](auto is_wrong) {
    return verified(
        changed(field, "winding", [&](float& value, std::size_t n) { value = is_wrong(n) ? -value : value; }), mesh);
  };
  const VerifyResult one = wrong_at([](std::size_t n) { return n == 1234; });
  EXPECT_EQ(one.sign.wrong, 1);
  EXPECT_FALSE(one.ok());
  EXPECT_EQ(one.samples_wrong, 0) << "its distance is right";
  EXPECT_EQ(kSignGrid.index(one.sign.worst.i, one.sign.worst.j, one.sign.worst.k), 1234);
  EXPECT_EQ(one.sign.worst.stored<0, one.sign.worst.expected> 0);
  EXPECT_EQ(one.sign.worst_winding > 0, one.sign.worst.expected < 0);

  const VerifyResult many = wrong_at([](std::size_t n) { return n % 7 == 0; });
  EXPECT_EQ(many.sign.wrong, (kSignGrid.sample_count() + 6) / 7);
  float farthest = 0;
  for (std::size_t n = 0; n < static_cast<std::size_t>(kSignGrid.sample_count()); n += 7)
    farthest = std::max(farthest, std::abs(field.to_dense()[n]));
  EXPECT_EQ(std::abs(many.sign.worst.stored), farthest);
}

// Samples a unit in the last place off the faces of a box have a sign; samples on the faces have none.
TEST(VerifySign, SamplesBesideTheSurface) {
  const double s = 0.7;
  Mesh mesh = mesh_of({{Vec3{0, 0, 0}, Vec3{s, 0, 0}, Vec3{0, s, 0}, Vec3{0, 0, s}}});
  const double ulp = std::nextafter(0.25, 1.0) - 0.25;
  // Samples below, on and above z = 0; x and y are well inside.
  const Grid grid{{1, 1, 3}, {0.125, 0.125, -ulp}, {1, 1, ulp}};
  const auto found = [&](float below, float on, float above) {
    DistanceField field = DistanceField::from_dense(grid, kFullField, std::vector{below, on, above});
    field.set_provenance({"tiles", 0, "1", "winding"});
    return verify(field, mesh);
  };
  const auto tiny = static_cast<float>(ulp);
  const VerifyResult right = found(tiny, tiny, -tiny);
  EXPECT_EQ(right.sign.checked, 2);
  EXPECT_EQ(right.sign.unknown, 1);
  EXPECT_TRUE(right.ok());
  EXPECT_EQ(found(-tiny, tiny, -tiny).sign.wrong, 1);
  EXPECT_EQ(found(tiny, -tiny, tiny).sign.wrong, 1);
  EXPECT_EQ(found(0, 0, 0).sign.unknown, 3) << "0 has no side";
}

// Half of a solid is missing: by definition, the sum of solid angles decides the sign.
TEST(VerifySign, OpenMeshesByTheGeneralisedWindingNumber) {
  Mesh mesh = solid_soup(4, 5);
  mesh.triangles.erase(mesh.triangles.begin() + 3, mesh.triangles.begin() + 6);
  mesh.triangles.pop_back();
  const DistanceField plain = signed_field(mesh, {});
  const auto winding = [&](std::size_t n) {
    const auto i = static_cast<std::int64_t>(n);
    const Vec3 p = kSignGrid.position(i % kSignGrid.size.x, i / kSignGrid.size.x % kSignGrid.size.y,
                                      i / kSignGrid.size.x / kSignGrid.size.y);
    return winding_by_angles({mesh}, p).value;
  };
  const auto field_by = [&](const std::string& name, auto is_inside) {
    return changed(plain, name, [&](float& value, std::size_t n) { value = is_inside(winding(n)) ? -value : value; });
  };
  const VerifyResult positive = verified(field_by("winding", [](double w) { return w > 0.5; }), mesh);
  EXPECT_TRUE(positive.ok());
  EXPECT_EQ(positive.sign.checked, kSignGrid.sample_count());
  EXPECT_TRUE(verified(field_by("winding nonzero", [](double w) { return std::abs(w) > 0.5; }), mesh).ok());
  EXPECT_GT(verified(field_by("winding", [](double w) { return w > 0.45; }), mesh).sign.wrong, 0);
  // This mesh has no parity.
  const VerifyResult parity = verified(renamed(plain, "parity"), mesh);
  EXPECT_FALSE(parity.sign.can_check);
  EXPECT_EQ(parity.sign.checked, 0);
}

// The field of the right mesh, and a file of the mesh with one reversed face.
TEST(VerifySign, MeshesThatWereOrientedFirst) {
  const Mesh right = solid_soup(9, 1);
  Mesh mesh = right;
  std::swap(mesh.triangles[2][0], mesh.triangles[2][1]);
  const DistanceField field =
      signed_field(right, {.method = SignMethod::winding, .rule = WindingRule::nonzero, .as_oriented = true});
  EXPECT_TRUE(verified(renamed(field, "winding nonzero"), right).ok());
  const VerifyResult oriented = verified(renamed(field, "winding nonzero oriented"), mesh);
  EXPECT_EQ(oriented.sign.wrong, 0);
  EXPECT_EQ(oriented.sign.checked, kSignGrid.sample_count());
  EXPECT_GT(verified(renamed(field, "winding nonzero"), mesh).sign.wrong, 0);
}

// Just above a square the winding number is nearly 1/2, just below it nearly -1/2; exactly in its plane it has none.
TEST(VerifySign, ThresholdsAreNotDecided) {
  const Mesh square{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const Grid grid{{1, 1, 3}, {0.3, 0.2, -1e-8}, {1, 1, 1e-8}};
  DistanceField field = DistanceField::from_dense(grid, kFullField, std::vector{1e-8f, 1e-9f, 1e-8f});
  field.set_provenance({"tiles", 0, "1", "winding"});
  const VerifyResult found = verify(field, square);
  EXPECT_EQ(found.sign.unknown, 1) << "that in the plane; beside it w is 1/2 - 5e-9";
  EXPECT_EQ(found.sign.wrong, 0);
}

TEST(VerifySign, FloodIsCheckedBeyondTheMesh) {
  const Mesh mesh = solid_soup(5, 2);
  const Box box = bounds(mesh);
  const DistanceField field = renamed(signed_field(mesh, kAsItIs), "flood");
  const VerifyResult right = verified(field, mesh);
  EXPECT_TRUE(right.ok());
  EXPECT_GT(right.sign.checked, 100);
  EXPECT_GT(right.sign.unknown, 100);
  EXPECT_LT(kSignGrid.origin.x, box.min.x);
  const VerifyResult leaked =
      verified(changed(field, "flood", [](float& value, std::size_t n) { value = n == 0 ? -value : value; }), mesh);
  EXPECT_EQ(leaked.sign.wrong, 1);
  EXPECT_TRUE(std::isnan(leaked.sign.worst_winding));
  EXPECT_EQ(verified(renamed(field, "flood inverted"), mesh).sign.wrong, right.sign.checked);
}

// Behind a sheet is inside; for a solid the signs equal those by the winding number.
TEST(VerifySign, NormalsByTheSideOfTheNearestTriangle) {
  Random random(3);
  Mesh sheet;
  for (int n = 0; n < 100; ++n) sheet.vertices.push_back({n % 10 - 4.5, n / 10 - 4.5, random.between(-0.2, 0.2)});
  for (std::uint32_t n = 0; n < 89; ++n)
    if (n % 10 != 9) {
      sheet.triangles.push_back({n, n + 1, n + 11});
      sheet.triangles.push_back({n, n + 11, n + 10});
    }
  const DistanceField plain = signed_field(sheet, {});
  const auto below = [&](float& value, std::size_t n) {
    const auto k = static_cast<std::int64_t>(n) / (kSignGrid.size.x * kSignGrid.size.y);
    if (kSignGrid.position(0, 0, k).z < 0) value = -value;
  };
  // Between the sheet's lowest and highest points, this test does not know what is below it.
  const auto wrong_outside = [&](const VerifyResult& found) {
    return found.sign.wrong > 0 && std::abs(found.sign.worst.position.z) > 0.25;
  };
  const VerifyResult right = verified(changed(plain, "normal", below), sheet);
  EXPECT_FALSE(wrong_outside(right));
  EXPECT_GT(right.sign.checked, right.samples * 3 / 4);
  EXPECT_TRUE(wrong_outside(verified(changed(plain, "normal inverted", below), sheet)));
  EXPECT_TRUE(wrong_outside(verified(renamed(plain, "normal"), sheet)));

  const Mesh solid = solid_soup(10, 1);
  const DistanceField field = signed_field(solid, {.method = SignMethod::winding});
  const bool is_turned = field.provenance().sign == "winding oriented";
  const VerifyResult same = verified(renamed(field, is_turned ? "normal oriented" : "normal"), solid);
  EXPECT_EQ(same.sign.wrong, 0);
  EXPECT_GT(same.sign.checked, 300) << "beyond its edges and corners it is not decided";
  EXPECT_GT(same.sign.negative, 0);
}

TEST(VerifySign, ShellsAreDistancesLessHalfTheirThickness) {
  const Mesh mesh = solid_soup(6, 1);
  const DistanceField plain = signed_field(mesh, {SignMethod::none}, 0.5);
  const auto shell = [&](const std::string& name, float by) {
    return verified(changed(plain, name, [by](float& value, std::size_t) { value = std::min(value - by, 0.4f); }),
                    mesh);
  };
  std::vector<float> values = plain.to_dense();
  for (float& value : values) value = std::min(value - 0.1f, 0.4f);
  DistanceField field = DistanceField::from_dense(kSignGrid, 0.4, values);
  field.set_provenance({"tiles", 0, "1", "shell 0.2"});
  const VerifyResult right = verified(field, mesh);
  EXPECT_TRUE(right.ok()) << right.samples_wrong << ", " << right.sign.wrong;
  EXPECT_GT(right.sign.negative, 10);
  EXPECT_EQ(right.sign.checked + right.sign.unknown, right.samples);
  field.set_provenance({"tiles", 0, "1", "shell 0.21"});
  EXPECT_GT(verified(field, mesh).samples_wrong, 0);
  EXPECT_GT(shell("shell 0.2", 0.2f).samples_wrong, 0);
}

// verify confirms every field that compute makes of a mesh with holes, flipped faces and several solids.
TEST(VerifySign, AllThatComputeMakes) {
  Mesh broken = solid_soup(11, 5);
  broken.triangles.erase(broken.triangles.begin() + 9);
  std::swap(broken.triangles[4][0], broken.triangles[4][1]);
  broken.triangles.push_back(broken.triangles[6]);
  for (const SignOptions& sign :
       {kAsItIs, SignOptions{.method = SignMethod::winding}, SignOptions{.method = SignMethod::normal},
        SignOptions{.method = SignMethod::flood}, SignOptions{.method = SignMethod::automatic},
        SignOptions{.method = SignMethod::winding, .rule = WindingRule::nonzero, .invert = true},
        SignOptions{.method = SignMethod::winding, .rule = WindingRule::odd},
        SignOptions{.method = SignMethod::shell, .shell = 0.3},
        SignOptions{.method = SignMethod::shell, .invert = true, .shell = 0.05}})
    for (const double thickness : {0.1, kFullField}) {
      const DistanceField field = compute(broken, kSignGrid, thickness, {.sign = sign, .nearest = true}).field;
      const VerifyResult found = verified(field, broken);
      EXPECT_TRUE(found.ok()) << found.sign.method << " within " << thickness << ": worst " << found.sign.worst.stored
                              << " at distance " << found.sign.worst.expected << ", " << found.samples_wrong
                              << " values, " << found.nearest_wrong << " triangles, " << found.sign.wrong << " signs";
      EXPECT_GT(found.sign.checked, 50) << found.sign.method;
    }
}

TEST(VerifySign, WhatIsNotKnownIsNotJudged) {
  const Mesh mesh = solid_soup(7, 3);
  const DistanceField field = signed_field(mesh, kAsItIs);
  for (const char* name : {"", "by hand", "winding or so"}) {
    const VerifyResult found = verified(renamed(field, name), mesh);
    EXPECT_TRUE(found.ok()) << name;
    EXPECT_FALSE(found.sign.can_check) << name;
    EXPECT_EQ(found.sign.checked, 0) << name;
    EXPECT_EQ(found.sign.unknown, found.samples) << name;
    EXPECT_GT(found.sign.negative, 0) << name;
    EXPECT_EQ(found.sign.method, name);
  }
}

TEST(VerifySign, TheSameForAnyNumberOfThreads) {
  const Mesh mesh = solid_soup(8, 6);
  const DistanceField field = changed(signed_field(mesh, kAsItIs), "winding",
                                      [](float& value, std::size_t n) { value = n % 11 == 0 ? -value : value; });
  VerifyOptions one, two;
  one.execution.threads = 1;
  two.execution.threads = 2;
  const VerifyResult a = verify(field, mesh, one), b = verify(field, mesh, two);
  EXPECT_EQ(a.sign.wrong, b.sign.wrong);
  EXPECT_GT(a.sign.wrong, 0);
  EXPECT_EQ(a.sign.worst.position, b.sign.worst.position);
}

}  // namespace
}  // namespace standoff::testing
