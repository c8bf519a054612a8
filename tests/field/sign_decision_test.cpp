// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// A sign is decided once: windows by the decision's bytes have the bits of the whole field, and bytes of others do no
// harm.
#include "standoff/sign_decision.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "sign/decision.h"
#include "standoff/windows.h"
#include "tests/collision/bodies.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/expect_error.h"
#include "tests/support/random_mesh.h"
#include "tests/support/sanitized.h"

namespace standoff::testing::of_decisions {
namespace {

const Grid kGrid{{40, 33, 37}, {-1.3, -1.25, -1.2}, {0.066, 0.08, 0.07}};
constexpr double kThickness = 0.16;
using Bytes = std::vector<std::byte>;

Mesh turned(Mesh mesh, std::size_t every) {
  for (std::size_t t = 0; t < mesh.triangles.size(); t += every) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  return mesh;
}

struct Case {
  const char* name;
  Mesh mesh;
};

std::vector<Case> cases() {
  Mesh open = with_hole(ball_mesh(1, 6), 40, 55);
  // Corners at -0 and +0 are one.
  for (Vec3& v : open.vertices)
    if (std::abs(v.x) < 1e-9) v.x = std::signbit(v.y) ? -0.0 : 0.0;
  const Mesh nested = joined(ball_mesh(1, 6), joined(ball_mesh(0.7, 5), ball_mesh(0.4, 4)));
  return {{"ball", ball_mesh(1, 6)},
          {"inside out", turned(ball_mesh(1, 6), 1)},
          {"faces turned", turned(ball_mesh(1, 6), 3)},
          {"open", turned(open, 2)},
          {"nested", nested},
          {"two sides", joined(ball_mesh(1, 5), turned(ball_mesh(1, 5), 1))},
          {"overlapping", joined(ball_mesh(0.6, 5), ball_mesh(0.6, 5, {0.3, 0.3, 0.3}))},
          {"soup", random_soup(3, 200, 1, 0.3)},
          {"nasty soup", nasty_soup(3, 60, 1)}};
}

ComputeOptions by(const SignOptions& sign) {
  return {.sign = sign, .execution = {.threads = 2, .backend = Backend::cpu}};
}

// The same decision, read by somebody else.
SignDecision sent(const SignDecision& decision) {
  const Bytes bytes = decision.bytes();
  return SignDecision::from_bytes(bytes);
}

void expect_equal(const DistanceField& a, const DistanceField& b) {
  ASSERT_EQ(a.grid(), b.grid());
  const std::vector<float> mine = a.to_dense(), theirs = b.to_dense();
  ASSERT_EQ(mine.size(), theirs.size());
  EXPECT_EQ(std::memcmp(mine.data(), theirs.data(), sizeof(float) * mine.size()), 0);
}

void expect_equal(const SignReport& a, const SignReport& b) {
  EXPECT_EQ(a.method, b.method);
  EXPECT_EQ(a.why, b.why);
  EXPECT_EQ(a.sure, b.sure);
  EXPECT_EQ(a.flipped, b.flipped);
  EXPECT_EQ(a.left_out, b.left_out);
  EXPECT_EQ(a.boundary_edges, b.boundary_edges);
  EXPECT_EQ(a.internal, b.internal);
  EXPECT_EQ(a.cut, b.cut);
}

void expect_decided_once(const Mesh& mesh, const ComputeOptions& options) {
  const Size3 side{16, 32, 37};
  WindowComputation first(mesh, kGrid, kThickness, side, options);
  ComputeOptions decided = options;
  decided.decision = sent(first.decision());
  WindowComputation second(mesh, kGrid, kThickness, side, decided);
  EXPECT_EQ(decided.decision.bytes(), second.decision().bytes());
  EXPECT_EQ(decided.decision.mesh_hash(), content_hash(mesh));
  expect_equal(decided.decision.report(), first.report().sign);
  expect_equal(second.report().sign, first.report().sign);
  DistanceField mine, theirs;
  for (const Size3& at : {Size3{16, 0, 0}, Size3{0, 16, 16}, Size3{32, 0, 0}}) {
    const Size3 size{std::min(side.x, kGrid.size.x - at.x), std::min(side.y, kGrid.size.y - at.y),
                     std::min(side.z, kGrid.size.z - at.z)};
    first.compute(at, size, mine);
    second.compute(at, size, theirs);
    expect_equal(mine, theirs);
    EXPECT_EQ(mine.provenance().sign, theirs.provenance().sign);
    EXPECT_EQ(mine.provenance().mesh_hash, theirs.provenance().mesh_hash);
  }
  expect_equal(compute(mesh, kGrid, kThickness, options).field, compute(mesh, kGrid, kThickness, decided).field);
}

std::vector<SignOptions> signs() {
  std::vector<SignOptions> all;
  for (const SignMethodInfo& info : kSignMethods) {
    SignOptions sign{.method = info.method, .shell = info.method == SignMethod::shell ? 0.1 : 0};
    all.push_back(sign);
    if (info.method == SignMethod::none) continue;
    if (kSanitized) continue;
    sign.invert = true;
    sign.as_oriented = info.by_orientation;
    all.push_back(sign);
  }
  all.push_back({.rule = WindingRule::odd});
  all.push_back({.outer = true});
  return all;
}

TEST(SignDecision, GivesWindowsTheirBits) {
  int compared = 0;
  for (const Case& one : cases())
    for (const SignOptions& sign : signs()) {
      SCOPED_TRACE(std::string(one.name) + ", " + find_info(sign.method)->name);
      try {
        WindowComputation(one.mesh, kGrid, kThickness, {16, 16, 16}, by(sign));
      } catch (const Error&) {
        continue;  // parity and outer are for closed meshes
      }
      expect_decided_once(one.mesh, by(sign));
      ++compared;
    }
  EXPECT_GT(compared, kSanitized ? 50 : 100);
}

// What a decision says is believed: its reason is not found again.
TEST(SignDecision, IsNotMadeAgain) {
  for (const Case& one : cases()) {
    WindowComputation first(one.mesh, kGrid, kThickness, {16, 16, 16}, by({}));
    Bytes bytes = first.decision().bytes();
    const std::string why = first.report().sign.why;
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t at = text.find(why);
    ASSERT_NE(at, text.npos);
    bytes[at] = std::byte{'#'};
    ComputeOptions options = by({});
    options.decision = SignDecision::from_bytes(sealed(std::span(bytes).subspan(kSealBytes)));
    WindowComputation second(one.mesh, kGrid, kThickness, {16, 16, 16}, options);
    EXPECT_EQ(second.report().sign.why, "#" + why.substr(1)) << one.name;
  }
}

TEST(SignDecision, IsSmallWhereThereIsLittleToDecide) {
  const Mesh ball = ball_mesh(1, 30);
  for (const SignMethod method : {SignMethod::none, SignMethod::winding, SignMethod::automatic})
    EXPECT_LT(WindowComputation(ball, kGrid, 0.1, {16, 16, 16}, by({method})).decision().bytes().size(), 300);
  const Mesh mixed = turned(ball, 2);
  EXPECT_LT(WindowComputation(mixed, kGrid, 0.1, {16, 16, 16}, by({})).decision().bytes().size(),
            300 + mixed.triangles.size());
}

TEST(SignDecision, OfOthersIsRefused) {
  const Mesh open = cases()[3].mesh;
  const auto windows = [&](const Mesh& mesh, const Grid& grid, const SignOptions& sign, const SignDecision& decision) {
    ComputeOptions options = by(sign);
    options.decision = decision;
    return WindowComputation(mesh, grid, kThickness, {16, 16, 16}, options);
  };
  const auto decided = [&](const SignOptions& sign) { return sent(windows(open, kGrid, sign, {}).decision()); };
  const SignDecision automatic = decided({});
  Mesh moved = open;
  moved.vertices[0].x += 1e-9;
  Grid other = kGrid;
  other.spacing.x *= 2;
  const auto refused = [&](const Mesh& mesh, const Grid& grid, const SignOptions& sign, const SignDecision& decision,
                           const char* why) {
    expect_error([&] { windows(mesh, grid, sign, decision); }, ErrorCode::usage, why);
  };
  refused(moved, kGrid, {}, automatic, "another mesh");
  refused(open, kGrid, {SignMethod::winding}, automatic, "the sign method auto, not winding");
  refused(open, kGrid, {.rule = WindingRule::odd}, automatic, "another winding rule");
  refused(open, kGrid, {.as_oriented = true}, automatic, "orientation is repaired");
  refused(open, kGrid, {.outer = true}, automatic, "all triangles");
  refused(open, kGrid, {.method = SignMethod::shell, .shell = 0.1},
          decided({.method = SignMethod::shell, .shell = 0.2}), "another thickness");
  refused(open, other, {SignMethod::flood}, decided({SignMethod::flood}), "another grid");
  windows(open, other, {}, automatic);
  windows(open, kGrid, {.invert = true}, automatic);
  expect_error(
      [&] { windows(open, kGrid, {.method = SignMethod::flood, .strict = true}, decided({SignMethod::flood})); },
      ErrorCode::doubt, "strict");
  expect_error([] { static_cast<void>(SignDecision().report()); }, ErrorCode::usage, "empty");
  EXPECT_TRUE(SignDecision().bytes().empty());
}

TEST(SignDecision, OfNoDecisionIsRefused) {
  const Mesh ball = ball_mesh(1, 4);
  Bytes bytes = WindowComputation(ball, kGrid, 0.1, {16, 16, 16}, by({})).decision().bytes();
  const auto refused = [](const Bytes& some, const char* why) {
    expect_error([&] { SignDecision::from_bytes(some); }, ErrorCode::input, why);
  };
  refused({}, "no decision");
  refused(Bytes(100), "no decision");
  Bytes later = bytes;
  later[8] = std::byte{77};
  refused(later, "version 77");
  for (std::size_t size = 1; size < bytes.size(); ++size) refused(Bytes(bytes.begin(), bytes.begin() + size), "; ");
  bytes.push_back({});
  refused(bytes, "checksum");
}

// Copies with bytes that were changed, cut or put in. Without their seal none is taken. With one, what is wrong in
// them is found, or a field is computed.
TEST(SignDecision, DamagedBytesDoNoHarm) {
  Random random(7);
  const int copies = kSanitized ? 40 : 200;
  for (const Case& one : cases())
    for (const SignMethod method : {SignMethod::automatic, SignMethod::winding, SignMethod::flood}) {
      const SignOptions sign{method};
      const Bytes bytes = WindowComputation(one.mesh, kGrid, kThickness, {16, 16, 16}, by(sign)).decision().bytes();
      for (int n = 0; n < copies; ++n) {
        Bytes damaged(bytes.begin() + kSealBytes, bytes.end());
        const auto place = [&] { return random.below(static_cast<std::uint32_t>(damaged.size())); };
        // Mostly in the lists.
        for (std::uint32_t changes = 1 + random.below(3); changes > 0; --changes) {
          const std::uint32_t at = n % 2 == 0 ? place() : std::max(place(), place());
          switch (random.below(4)) {
            case 0:
              damaged[at] ^= static_cast<std::byte>(1 << random.below(8));
              break;
            case 1:
              damaged[at] = static_cast<std::byte>(random.below(256));
              break;
            case 2:
              damaged.erase(damaged.begin() + at);
              break;
            default:
              damaged.insert(damaged.begin() + at, static_cast<std::byte>(random.below(256)));
          }
        }
        if (std::ranges::equal(damaged, std::span(bytes).subspan(kSealBytes))) continue;
        Bytes unsealed(bytes.begin(), bytes.begin() + kSealBytes);
        unsealed.insert(unsealed.end(), damaged.begin(), damaged.end());
        expect_error([&] { SignDecision::from_bytes(unsealed); }, ErrorCode::input, "damaged");
        try {
          ComputeOptions options = by(sign);
          options.decision = SignDecision::from_bytes(sealed(damaged));
          WindowComputation windows(one.mesh, kGrid, kThickness, {16, 16, 16}, options);
          DistanceField field;
          windows.compute({16, 16, 16}, {16, 16, 16}, field);
        } catch (const Error& error) {
          EXPECT_TRUE(error.code() == ErrorCode::input || error.code() == ErrorCode::usage) << error.what();
        }
      }
    }
}

}  // namespace
}  // namespace standoff::testing::of_decisions
