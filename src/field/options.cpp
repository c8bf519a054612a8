// SPDX-License-Identifier: Apache-2.0
#include "field/options.h"

#include <cmath>
#include <string>

#include "core/execution.h"

namespace standoff {

void validate(double thickness, const ComputeOptions& options) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("compute: ") + what); };
  if (!(thickness > 0)) fail("the thickness must be positive; infinity gives a full field");
  validate("compute", options.execution, Runs::everywhere);
  if (options.memory_limit < 0) fail("the memory limit is negative; give bytes, or zero for none");
  if (options.skip.kind == SkipRule::Kind::neighbour && !(options.skip.fraction > 0 && options.skip.fraction <= 1))
    fail("the neighbour rule's fraction must be above 0 and at most 1; 1 is the thesis's");
  // Numbers that were cast to an enumeration.
  const auto one_of = [](auto value, auto last) { return value >= decltype(value){} && value <= last; };
  if (!one_of(options.method, Method::thesis) || !one_of(options.skip.kind, SkipRule::Kind::exact))
    fail("there is no such method or skip rule; take one of enum Method and of SkipRule::Kind");
  if (!one_of(options.sign.method, SignMethod::shell) || !one_of(options.sign.rule, WindingRule::odd))
    fail("there is no such sign method or winding rule; take one of enum SignMethod and of WindingRule");
  if (options.sign.method != SignMethod::winding && options.sign.rule != WindingRule::positive)
    fail("a winding rule is for the sign method winding alone; leave it out");
  if (options.sign.method == SignMethod::shell && !(options.sign.shell > 0 && std::isfinite(options.sign.shell)))
    fail("the sign method shell needs a thickness of the shell that is positive and finite");
  if (options.sign.method != SignMethod::shell && options.sign.shell != 0)
    fail("a thickness of the shell is for the sign method shell alone; leave it out");
  if (options.sign.method == SignMethod::none && options.sign.invert)
    fail("a field without a sign cannot be inverted; choose a sign method");
}

SkipRule effective_rule(const ComputeOptions& options) {
  if (options.skip.kind != SkipRule::Kind::automatic) return options.skip;
  return {options.method == Method::thesis ? SkipRule::Kind::neighbour : SkipRule::Kind::none, 1};
}

}  // namespace standoff
