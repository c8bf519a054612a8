// SPDX-License-Identifier: Apache-2.0
// Any bytes give a query or Error{input}; of a query, whatever sign it holds, answers end and stay inside its arrays.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "points/query_file.h"
#include "standoff/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace standoff;
  try {
    const FileView file("fuzzed", {reinterpret_cast<const char*>(data), size});
    const MeshQuery query = read_query_file(file, ArrayChecksum::ignored);
    const Box box = bounds(query.mesh());
    std::array<Vec3, 5> points{Vec3{}, box.min, box.max, box.center(), Vec3{1, 2, 3}};
    std::array<ClosestPoint, 5> found;
    query.closest(points, found);
    for (const ClosestPoint& at : found)
      if (!std::isfinite(at.distance) || at.triangle >= query.mesh().triangles.size()) std::abort();
    std::array<double, 5> windings{};
    if (query.sign().method == SignMethod::winding) query.winding_numbers(points, windings);
    for (const double winding : windings)
      if (!std::isfinite(winding)) std::abort();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input || !std::string_view(error.what()).starts_with("fuzzed:")) std::abort();
  }
  return 0;
}
