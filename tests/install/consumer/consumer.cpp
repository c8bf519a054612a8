// The smallest user of difi: the field of one triangle, looked up at one sample.
#include <difi/compute.h>
#include <difi/field.h>
#include <difi/grid.h>
#include <difi/mesh.h>

#include <cstdio>

int main() {
  const difi::Mesh mesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}};
  const difi::Grid grid{.size = {9, 9, 9}, .origin = {0, 0, 0}, .spacing = {0.125, 0.125, 0.125}};
  const difi::Computed computed = difi::compute(mesh, grid, {.thickness = 0.5});
  std::printf("distance %g of %d triangle\n", computed.field.value(2, 2, 2), int(computed.report.triangles));
}
