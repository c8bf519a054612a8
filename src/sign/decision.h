// SPDX-License-Identifier: Apache-2.0
// The content of a SignDecision: bytes, and what their head says. The lists behind it are unpacked for a mesh, whose
// size bounds them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sign/plan.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/sign_decision.h"

namespace standoff {

/// The checksum, and all that it is of.
class SignDecisionContent {
 public:
  /// Reads the head. Throws Error{input}.
  explicit SignDecisionContent(std::vector<std::byte> bytes);

  std::span<const std::byte> bytes() const { return bytes_; }
  std::uint64_t mesh_hash = 0;
  std::uint64_t triangles = 0;
  SignOptions made_for;
  SignReport report;
  std::optional<Grid> grid;                                  ///< of the flood
  std::span<const std::byte> use, exposed, boundary, flood;  ///< packed: of SignPlan

  SignDecisionContent(const SignDecisionContent&) = delete;
  SignDecisionContent& operator=(const SignDecisionContent&) = delete;

 private:
  std::vector<std::byte> bytes_;
};

struct SignDecisionAccess {
  static SignDecision made_of(std::vector<std::byte> bytes) {
    return SignDecision(std::make_shared<const SignDecisionContent>(std::move(bytes)));
  }
  /// Requires a decision.
  static const SignDecisionContent& content(const SignDecision& decision) { return *decision.content_; }
};

/// The decision of a plan whose signs are made. `hash`: of the mesh. Requires the grid of the plan's flood.
SignDecision decision_of(const SignPlan& plan, MeshView mesh, std::uint64_t hash, const SignOptions& options,
                         const Grid& grid);

/// The plan of a decision. Throws Error{usage} where the decision is for another mesh, grid or other options,
/// Error{input} where it is damaged, Error{doubt} where it is not certain and the options are `strict`. `hash`: of the
/// mesh, which must be valid.
SignPlan plan_of(const SignDecision& decision, MeshView mesh, std::uint64_t hash, const SignOptions& options,
                 const Grid& grid);

/// The plan of a decision that was made for this mesh, and this grid if it has one. Throws Error{input} where it is
/// damaged.
SignPlan plan_of(const SignDecisionContent& content, MeshView mesh, const Grid& grid);

/// Puts the mark, the version and the checksum before the bytes of a decision.
std::vector<std::byte> sealed(std::span<const std::byte> content);
/// How many bytes that are.
inline constexpr std::size_t kSealBytes = 20;

}  // namespace standoff
