// SPDX-License-Identifier: Apache-2.0
// The check of a sign's options, which plan.h declares. Apart from plan.cpp, as script/gpu-check links nothing else of
// it.
#include <cmath>
#include <string>

#include "sign/plan.h"
#include "standoff/error.h"

namespace standoff {

void validate(const SignOptions& options) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("compute: ") + what); };
  const auto is = [&](SignMethod method) { return options.method == method; };
  // Reject numbers that were cast to an enumeration.
  const auto one_of = [](auto value, auto last) { return value >= decltype(value){} && value <= last; };
  const SignMethodInfo* const info = find_info(options.method);
  if (!info || !one_of(options.rule, WindingRule::odd))
    fail("there is no such sign method or winding rule; take one of enum SignMethod and of WindingRule");
  if (options.rule != WindingRule::positive && !is(SignMethod::winding) && !is(SignMethod::automatic))
    fail("a winding rule is for the sign methods winding and automatic; leave it out");
  if (options.invert && is(SignMethod::none)) fail("a field without a sign cannot be inverted; choose a sign method");
  if (options.as_oriented && !info->by_orientation)
    fail("this sign method does not look at the orientation of triangles; leave out that it is taken as it is");
  if (options.strict && is(SignMethod::none))
    fail("a field without a sign has none to be strict about; choose a sign method");
  if (options.outer && !is(SignMethod::winding) && !is(SignMethod::automatic))
    fail("outer is for the sign methods winding and automatic; leave it out");
  if (is(SignMethod::shell) && !(options.shell > 0 && std::isfinite(options.shell)))
    fail("the thickness of a shell must be positive and finite; give it in world units");
  if (!is(SignMethod::shell) && options.shell != 0)
    fail("a shell's thickness is for the sign method shell; leave it out");
}

}  // namespace standoff
