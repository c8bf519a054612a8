// SPDX-License-Identifier: Apache-2.0
// The table of the methods: how each is planned and made. What is said of them is in standoff/sign.h.
#pragma once

#include <memory>
#include <string>

#include "core/progress.h"
#include "sign/make_signs.h"
#include "sign/plan.h"
#include "sign/signs.h"
#include "standoff/sign.h"

namespace standoff {

struct SignMethodSteps {
  SignMethod method;
  /// Fills the plan (plan_sign). `report.method` is there already.
  void (*plan)(SignPlan& plan, MeshView mesh, const SignOptions& options, ProgressMeter& progress);
  /// As make_signs(); nullptr where no SampleSigns decide.
  std::unique_ptr<SampleSigns> (*make)(MeshView mesh, SignPlan& plan, const SignOptions& options,
                                       const UnsignedField& field, ProgressMeter& progress) = nullptr;
  bool in_slabs = true;        ///< decides layers of the grid one after another
  bool needs_nearest = false;  ///< of a field: UnsignedField::nearest
};

/// Requires a method that has a row in kSignMethods.
const SignMethodSteps& steps_of(SignMethod method);

}  // namespace standoff
