// SPDX-License-Identifier: Apache-2.0
// What a MeshQuery has prepared.
#pragma once

#include <memory>
#include <optional>

#include "points/sides_of_points.h"
#include "points/triangle_index.h"
#include "sign/plan.h"
#include "standoff/points.h"

namespace standoff {

struct MeshQuery::Data {
  Data(MeshView view, const MeshQueryOptions& options);

  /// Of the triangles that count for distances: with SignOptions::outer not all.
  const TriangleIndex& near() const { return exposed ? *exposed : *all; }

  Mesh mesh;
  SignOptions sign;
  SignPlan plan;
  std::optional<TriangleIndex> all, exposed;
  std::unique_ptr<SidesOfPoints> sides;
};

}  // namespace standoff
