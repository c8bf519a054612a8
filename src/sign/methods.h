// SPDX-License-Identifier: Apache-2.0
// The table of the methods: how each is planned and made, and the SampleSigns that a plan makes. Their names and texts
// are in standoff/sign.h.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "core/progress.h"
#include "sign/normal/nearest_triangles.h"
#include "sign/plan.h"
#include "sign/signs.h"
#include "standoff/grid.h"
#include "standoff/sign.h"

namespace standoff {

/// The field that needs a sign. Only SignMethod::normal and ::facet look at thickness and nearest triangles.
struct UnsignedField {
  const Grid& grid;
  double thickness = 0;  ///< all samples this near to the mesh have a nearest triangle
  NearestTriangles nearest = {};
  /// The bytes that crossings may take at a time (RowCrossings) where they can be found again.
  std::int64_t crossing_bytes = std::numeric_limits<std::int64_t>::max();
};

/// What must be known before the samples of a window get the signs that they have in the whole grid.
enum class SignScope {
  window,  ///< the triangles that its rows may cross
  grid,    ///< the grid and the mesh
  field,   ///< the whole field
};

struct SignMethodSteps {
  SignMethod method;
  /// Fills the plan (plan_sign). `report.method` is there already.
  void (*plan)(SignPlan& plan, MeshView mesh, const SignOptions& options, ProgressMeter& progress);
  /// As make_signs(); nullptr where no SampleSigns decide.
  std::unique_ptr<SampleSigns> (*make)(const OrientedMesh& mesh, SignPlan& plan, const SignOptions& options,
                                       const UnsignedField& field, ProgressMeter& progress) = nullptr;
  SignScope scope = SignScope::window;
  bool needs_nearest = false;  ///< of a field: UnsignedField::nearest
};

/// Requires a method that has a row in kSignMethods.
const SignMethodSteps& steps_of(SignMethod method);

/// The method of the plan for the field's samples; nothing if there is no inside after all. Reports in the plan what
/// the grid shows. Requires plan.has_sign(), and not SignMethod::shell (Shell). The mesh and the plan must stay where
/// they are. Throws Error{interrupted, doubt}.
std::unique_ptr<SampleSigns> make_signs(MeshView mesh, SignPlan& plan, const SignOptions& options,
                                        const UnsignedField& field, ProgressMeter& progress);
/// The same by those triangles of the mesh that are in `part`, of methods of SignScope::window: at least the ones that
/// rows of the grid, or the rays from there to smaller x, may cross. `part` must stay where it is.
std::unique_ptr<SampleSigns> make_signs_of_window(const OrientedMesh& part, SignPlan& plan, const SignOptions& options,
                                                  const UnsignedField& window, ProgressMeter& progress);

}  // namespace standoff
