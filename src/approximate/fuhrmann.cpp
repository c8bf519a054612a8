// SPDX-License-Identifier: Apache-2.0
// The method `fuhrmann`: each triangle is moved along its normal, by the thickness to both sides, and all samples in
// the box around that prism are measured. The 2008 thesis says that this "resembles somewhat our algorithm", which
// grows the triangle's own box instead.
//
// Source: A. Fuhrmann, G. Sobottka, C. Gross, Distance fields for rapid collision detection in physically based
// modeling, 2003.
//
// Not exact. Distances are Algorithm 1's, in float (thesis_distance.h). The box of the prism holds all samples over the
// face of the triangle within the thickness, so a sample whose nearest point is inside a face has the exact distance. A
// sample that is nearest to an edge or a vertex lies beside the prisms there; it has its distance if the box of some
// prism of that edge or vertex happens to hold it, else one that is too large, up to the thickness. Its sign there is
// SignMethod::facet, which fails near edges and vertices whose triangles see the sample on different sides.
#include <cmath>

#include "approximate/approximate.h"
#include "geometry/triangle_box.h"
#include "geometry/triple.h"
#include "thesis/thesis.h"
#include "thesis/thesis_distance.h"

namespace standoff::cpu {
namespace {

// The samples in the box around the prism; a triangle without area has no prism, but its own box.
SampleRange prism_samples(const Triple<double> (&corner)[3], const Grid& grid, double thickness) {
  const BoxOf<double> box = box_of(corner[0], corner[1], corner[2]);
  const Triple<double> normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
  const double twice_area = std::sqrt(dot(normal, normal));
  const double share = twice_area > 0 && std::isfinite(twice_area) ? thickness / twice_area : 0;
  const Vec3 grow{std::abs(normal.x) * share, std::abs(normal.y) * share, std::abs(normal.z) * share};
  return samples_in({vec_of(box.low) - grow, vec_of(box.high) + grow}, grid);
}

}  // namespace

Counts run_fuhrmann(const Job& job, Sink& sink) {
  job.progress.stage("distances", brick_count(job.grid), 0.2, 1);
  return run_in_boxes(job, sink, prism_samples);
}

}  // namespace standoff::cpu
