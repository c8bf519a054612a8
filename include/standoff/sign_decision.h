// SPDX-License-Identifier: Apache-2.0
// What a sign needs to know of the whole mesh, or of the whole grid, decided once and passed on: to the windows of a
// field that other processes and machines compute.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "standoff/export.h"
#include "standoff/sign.h"

namespace standoff {

class SignDecisionContent;

/// How the sign of a mesh's field was decided: the method and why, the orientation of the triangles, the boundary of
/// the mesh's holes, and of SignMethod::flood the sides that it found. WindowComputation::decision() makes it, and
/// ComputeOptions::decision takes it: then nothing is decided again, and the values have the same bits.
///
/// It is for one mesh, and for SignOptions with the same method, rule, as_oriented, outer and shell; `invert` and
/// `strict` may be others. A decision with a flood is for one grid, all others for any. Copies share their content.
class STANDOFF_API SignDecision {
 public:
  /// Nothing was decided.
  SignDecision() = default;

  /// Reads what bytes() wrote, on any machine. What is in it is checked where it is used, before it is relied upon, so
  /// bytes of others do no harm; they may decide a wrong sign. Errors: input (damaged, or of another version), limit.
  static SignDecision from_bytes(std::span<const std::byte> bytes);
  /// Some hundred bytes; with repaired triangles at most a byte for each of them, with holes some bytes for each of
  /// their edges, with a flood at most a byte for each tile of the grid and 64 for each at the surface. Empty if
  /// nothing was decided.
  std::vector<std::byte> bytes() const;

  bool empty() const { return !content_; }
  /// How the sign was decided. Requires a decision: empty() is false. Errors: usage.
  const SignReport& report() const;
  /// content_hash() of the mesh. Errors: usage.
  std::uint64_t mesh_hash() const;

 private:
  friend struct SignDecisionAccess;
  explicit SignDecision(std::shared_ptr<const SignDecisionContent> content) : content_(std::move(content)) {}
  const SignDecisionContent& expected() const;

  std::shared_ptr<const SignDecisionContent> content_;
};

}  // namespace standoff
