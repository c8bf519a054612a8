// SPDX-License-Identifier: Apache-2.0
#include "field/options.h"

#include <string>

#include "core/guarded.h"
#include "sign/options.h"

namespace standoff {

void validate(double thickness, const ComputeOptions& options) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("compute: ") + what); };
  if (!(thickness > 0)) fail("the thickness must be positive; infinity gives a full field");
  validate("compute", options.execution, Runs::everywhere);
  if (options.memory_limit < 0) fail("the memory limit is negative; give bytes, or zero for none");
  if (options.bytes_beside < 0 || options.bytes_beside > (1 << 20))
    fail("the bytes beside each sample must be 0 to 2^20; give the sum of bytes_per_sample()");
  if (options.skip.kind == SkipRule::Kind::neighbour && !(options.skip.fraction > 0 && options.skip.fraction <= 1))
    fail("the neighbour rule's fraction must be above 0 and at most 1; 1 is the thesis's");
  // Numbers that were cast to an enumeration.
  const auto one_of = [](auto value, auto last) { return value >= decltype(value){} && value <= last; };
  if (!one_of(options.method, Method::thesis) || !one_of(options.skip.kind, SkipRule::Kind::exact))
    fail("there is no such method or skip rule; take one of enum Method and of SkipRule::Kind");
  validate(options.sign);
}

SkipRule effective_rule(const ComputeOptions& options) {
  if (options.skip.kind != SkipRule::Kind::automatic) return options.skip;
  return {options.method == Method::thesis ? SkipRule::Kind::neighbour : SkipRule::Kind::none, 1};
}

}  // namespace standoff
