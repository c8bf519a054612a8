// SPDX-License-Identifier: Apache-2.0
// The plan of a sign, made before any distance is computed: which method, and in which orientation.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/progress.h"
#include "sign/diagnosis/boundary.h"
#include "sign/oriented_mesh.h"
#include "standoff/mesh.h"
#include "standoff/sign.h"

namespace standoff {

struct Caps;
struct FloodSides;

struct SignPlan {
  SignReport report;
  std::vector<std::int8_t> use;        ///< OrientedMesh::use
  std::vector<std::uint32_t> exposed;  ///< SignOptions::outer: triangles that are not internal, ascending; empty: all
  Boundary boundary;                   ///< of the mesh in that orientation; empty also where the method needs none
  std::shared_ptr<const Caps> caps;    ///< of the boundary; made with the first signs that need it
  std::shared_ptr<const FloodSides> flood;  ///< of the grid; made with the signs of SignMethod::flood

  bool has_sign() const { return report.method != SignMethod::none; }
};

/// Throws Error{input} where the method does not fit the mesh, Error{doubt} where it fits but is not certain and the
/// options are `strict`. Requires a valid mesh and valid options. Runs on the threads of the calling TBB arena.
/// `progress` is checked between steps.
SignPlan plan_sign(MeshView mesh, const SignOptions& options, ProgressMeter& progress);

/// What plan_sign() plans by SignMethod::winding for a mesh that is closed, and faces outwards or is taken as oriented;
/// by parity for one whose edges all have an even number of triangles.
SignPlan plan_of_closed(SignMethod method);

/// Whether a device may decide the sign, of a mesh that plan_of_closed() is for.
inline bool is_sign_on_device(const SignOptions& sign) {
  return (sign.method == SignMethod::winding || sign.method == SignMethod::automatic) && !sign.outer;
}

/// The most that a sign takes, beside what its rows and crossings take.
struct SignMemory {
  std::int64_t planning = 0;  ///< bytes that plan_sign() holds
  std::int64_t kept = 0;      ///< bytes of the plan
  std::int64_t boundary = 0;  ///< edges that caps may close (OpenWinding)
};
/// For any mesh of so many triangles: that of a diagnosis.
SignMemory most_sign_memory(std::int64_t triangles, const SignOptions& options, int threads);
/// For this mesh: one that is closed and faces outwards needs no diagnosis; of others the edges are counted. Requires a
/// valid mesh. Runs on the threads of the calling TBB arena.
SignMemory sign_memory(MeshView mesh, const SignOptions& options, int threads);

/// Throws Error{doubt} where the plan is not certain and the options are `strict`.
void expect_sure(const SignPlan& plan, const SignOptions& options);

/// Checks how a sign is asked for. Throws Error{usage} where options are invalid, or exclude each other.
void validate(const SignOptions& options);

}  // namespace standoff
