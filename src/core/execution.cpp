// SPDX-License-Identifier: Apache-2.0
#include "core/execution.h"

#include <string>

#include "standoff/error.h"
#include "standoff/testing/emulation.h"

namespace standoff {

void validate(const char* where, const Execution& execution, Runs runs) {
  const auto fail = [where](const std::string& what) {
    throw Error(ErrorCode::usage, std::string(where) + ": " + what);
  };
  if (execution.threads < 0 || execution.threads > kMaxThreads)
    fail(std::to_string(execution.threads) + " threads were asked for; ask for 1 to " + std::to_string(kMaxThreads) +
         ", or 0 for all");
  if (execution.device < 0)
    fail("there is no device " + std::to_string(execution.device) + "; devices are counted from 0");
  // Numbers that were cast to an enumeration.
  const auto one_of = [](auto value, auto last) { return value >= decltype(value){} && value <= last; };
  if (!one_of(execution.backend, Backend::cuda) && execution.backend != testing::kEmulated)
    fail("there is no such backend; take one of enum Backend");
  if (!one_of(execution.simd, Simd::avx512)) fail("there is no such instruction set; take one of enum Simd");
  if (runs == Runs::on_the_cpu && execution.backend != Backend::automatic && execution.backend != Backend::cpu)
    fail("this runs on the CPU only; take Backend::automatic or Backend::cpu");
}

}  // namespace standoff
