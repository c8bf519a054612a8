// SPDX-License-Identifier: Apache-2.0
// The smallest user of standoff: the field of one triangle, looked up at one sample. Where standoff was built without
// the component for it, the emulated GPU is refused in words.
#include <standoff/compute.h>
#include <standoff/error.h>
#include <standoff/field.h>
#include <standoff/grid.h>
#include <standoff/mesh.h>
#include <standoff/testing/emulation.h>

#include <cstdio>

int main() {
  const standoff::Mesh mesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}};
  const standoff::Grid grid{.size = {9, 9, 9}, .origin = {0, 0, 0}, .spacing = {0.125, 0.125, 0.125}};
  const standoff::ComputeResult computed = standoff::compute(mesh, grid, 0.5, {.sign = {standoff::SignMethod::none}});
  std::printf("distance %g of %d triangle\n", computed.field.value(2, 2, 2), int(computed.report.triangles));
  try {
    standoff::compute(mesh, grid, 0.5,
                      {.sign = {standoff::SignMethod::none}, .execution = {.backend = standoff::testing::kEmulated}});
    std::puts("emulated too");
  } catch (const standoff::Error& error) {
    std::puts(error.what());
  }
}
