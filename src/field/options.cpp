#include "field/options.h"

#include <string>

namespace difi {

void validate(const Options& options) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("compute: ") + what); };
  if (!(options.thickness > 0)) fail("the thickness must be positive; infinity gives a full field");
  if (options.threads < 0) fail("the number of threads must be zero (all) or more");
  if (options.memory_limit < 0) fail("the memory limit must be zero (none) or more");
  if (options.skip.kind == SkipRule::Kind::neighbour && !(options.skip.fraction > 0 && options.skip.fraction <= 1))
    fail("the neighbour rule's fraction must be above 0 and at most 1");
}

SkipRule effective_rule(const Options& options) {
  if (options.skip.kind != SkipRule::Kind::automatic) return options.skip;
  return {options.method == Method::thesis ? SkipRule::Kind::neighbour : SkipRule::Kind::none, 1};
}

}  // namespace difi
