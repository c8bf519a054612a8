// SPDX-License-Identifier: Apache-2.0
// Options as Python passes them. Names arrive checked: standoff/_options.py tells users which there are.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common.h"
#include "standoff/axis.h"
#include "standoff/execution.h"
#include "standoff/grid.h"
#include "standoff/sign.h"

namespace standoff::python {

/// (nx, ny, nz), origin, spacing.
/// Counts along the axes, as Python gives and gets them.
using Counts = std::array<std::int64_t, 3>;
inline Size3 size_of(const Counts& counts) { return {counts[0], counts[1], counts[2]}; }
inline Counts counts_of(const Size3& size) { return {size.x, size.y, size.z}; }

struct GridInput {
  std::array<std::int64_t, 3> size;
  std::array<double, 3> origin;
  std::array<double, 3> spacing;
  std::array<std::int64_t, 3> first;

  Grid grid() const {
    return {{size[0], size[1], size[2]},
            {origin[0], origin[1], origin[2]},
            {spacing[0], spacing[1], spacing[2]},
            {first[0], first[1], first[2]}};
  }
};

/// `device` is "auto", "cpu", "cuda", "cuda:N,N..." or "emulated"; returns the numbers. Errors: usage.
std::vector<int> devices_in(const std::string& device, Backend& backend);
/// The same with one number at the most.
Execution execution_of(int threads, const std::string& device);

/// The values are those of Sign in standoff/_options.py. Errors: usage (a name that does not exist).
SignOptions sign_of(const nb::handle& sign);

/// What a sign report says, for standoff/_options.py.
nb::dict sign_dict(const SignReport& report);

/// The entry of `names` that is `name`. Errors: usage.
std::size_t choice_of(const char* what, const std::string& name, std::span<const char* const> names);
/// The axis that points up; none for an empty name: the library finds it.
std::optional<Axis> up_of(const std::string& name);
/// The row that a name names, of a table of what the library has.
template <class Info, std::size_t kCount>
const Info& row_of(const char* what, const std::string& name, const Info (&rows)[kCount]) {
  std::vector<const char*> names;
  for (const Info& info : rows) names.push_back(info.name);
  return rows[choice_of(what, name, names)];
}

}  // namespace standoff::python
