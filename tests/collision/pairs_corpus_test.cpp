// SPDX-License-Identifier: Apache-2.0
// Pairs of bodies with answers that were once wrong: tests/corpus/pairs, whose expected.txt names the faults.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "standoff/collision.h"
#include "standoff/io.h"
#include "standoff/testing/emulation.h"
#include "tests/collision/bodies.h"
#include "tests/support/paths.h"

namespace standoff {
namespace {

using namespace standoff::testing;

struct Case {
  std::string name, answer;
  double margin = 0;
  Pose pose_a, pose_b;
};

Pose pose_from(std::string text) {
  Pose pose;
  if (text == "-") return pose;
  for (char& c : text) c = c == ',' ? ' ' : c;
  std::istringstream numbers(text);
  double* const to[3] = {&pose.translation.x, &pose.translation.y, &pose.translation.z};
  for (int row = 0; row < 3; ++row)
    numbers >> pose.rotation[3 * row] >> pose.rotation[3 * row + 1] >> pose.rotation[3 * row + 2] >> *to[row];
  EXPECT_TRUE(numbers) << text;
  return pose;
}

const std::string kFolder = std::string(kSourceFolder) + "/tests/corpus/pairs/";

std::vector<Case> cases() {
  std::ifstream file(kFolder + "expected.txt");
  std::vector<Case> cases;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    Case it;
    std::string pose_a, pose_b;
    words >> it.name >> it.margin >> it.answer >> pose_a >> pose_b;
    it.pose_a = pose_from(pose_a), it.pose_b = pose_from(pose_b);
    cases.push_back(it);
  }
  return cases;
}

TEST(PairsCorpus, AllQueriesTellTheTruth) {
  ASSERT_GE(cases().size(), 7u);
  for (const Case& it : cases()) {
    SCOPED_TRACE(it.name + ", margin " + std::to_string(it.margin));
    const Body a(read_mesh(kFolder + it.name + "_a.obj").mesh), b(read_mesh(kFolder + it.name + "_b.obj").mesh);
    const bool hit = it.answer == "hit";
    const CollideOptions within{.margin = it.margin};
    const Execution emulated{.backend = testing::kEmulated};
    EXPECT_EQ(collide(a, it.pose_a, b, it.pose_b, within).hit(), hit);
    EXPECT_EQ(collide(b, it.pose_b, a, it.pose_a, within).hit(), hit) << "with A and B swapped";
    EXPECT_EQ(collide_all(a, it.pose_a, b, {&it.pose_b, 1}, within, emulated).results[0].hit(), hit) << "emulated GPU";
    EXPECT_EQ(contacts(a, it.pose_a, b, it.pose_b, {.margin = it.margin}).contacts.empty(), !hit);
    EXPECT_EQ(distance(a, it.pose_a, b, it.pose_b).upper <= it.margin, hit);
    if (it.margin > 0) continue;
    const RigidMotion rest_b{it.pose_b, it.pose_b, {}}, rest_a{it.pose_a, it.pose_a, {}};
    EXPECT_EQ(sweep(a, it.pose_a, b, rest_b, {1e-9}).hit, hit) << "a sweep that goes nowhere";
    EXPECT_EQ(sweep(b, it.pose_b, a, rest_a, {1e-9}).hit, hit) << "with A and B swapped";
    EXPECT_EQ(sweep_all(a, it.pose_a, b, {&rest_b, 1}, {1e-9}, emulated).results[0].hit, hit) << "emulated GPU";
  }
}

}  // namespace
}  // namespace standoff
