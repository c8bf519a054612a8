// SPDX-License-Identifier: Apache-2.0
// Gives the values of an unsigned field their sign.
#pragma once

#include <span>

#include "core/progress.h"
#include "standoff/field.h"
#include "standoff/mesh.h"
#include "standoff/sign.h"

namespace standoff {

/// What a field's provenance says: "winding" or "parity"; empty for none.
const char* name_of(SignMethod method);

/// Throws Error{input} where the method does not fit the mesh. Requires a valid mesh.
void expect_signable(MeshView mesh, const SignOptions& options);

/// Negates the values inside. A tile that is not stored becomes an inside one, or is stored if it has samples on both
/// sides. Requires expect_signable(). Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
void sign_field(MeshView mesh, const SignOptions& options, DistanceField& field, ProgressMeter& progress);
/// The same for one value per sample, x fastest.
void sign_values(MeshView mesh, const SignOptions& options, const Grid& grid, std::span<float> values,
                 ProgressMeter& progress);

}  // namespace standoff
