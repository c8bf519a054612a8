// SPDX-License-Identifier: Apache-2.0
// Exit codes of failures that no command line brings about at will: bugs of our own, and memory that is not there.
#include "cli/process.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

#include "standoff/error.h"

namespace standoff::cli {
namespace {

struct Told {
  int code;
  std::string words;
};

template <class Run>
Told told(Run run) {
  ::testing::internal::CaptureStderr();
  const int code = exit_code_of(run);
  return {code, ::testing::internal::GetCapturedStderr()};
}

TEST(Failure, NoneIsZeroAndSilent) {
  const Told none = told([] {});
  EXPECT_EQ(none.code, 0);
  EXPECT_EQ(none.words, "");
}

TEST(Failure, BugsAreOne) {
  const Told bug = told([] { throw std::logic_error("a thing that\ncannot be"); });
  EXPECT_EQ(bug.code, 1);
  EXPECT_EQ(bug.words,
            "standoff: error: internal: a thing that cannot be; this is a bug in standoff, please report it\n");
}

TEST(Failure, MemoryThatIsNotThereIsALimit) {
  const Told memory = told([] { throw std::bad_alloc(); });
  EXPECT_EQ(memory.code, 5);
  EXPECT_EQ(memory.words.rfind("standoff: error: not enough memory; use a smaller mesh", 0), 0u) << memory.words;
}

TEST(Failure, ErrorsAreWhatTheySay) {
  for (const ErrorCode code : {ErrorCode::internal, ErrorCode::usage, ErrorCode::input, ErrorCode::output,
                               ErrorCode::limit, ErrorCode::verify}) {
    const Told error = told([&] { throw Error(code, "a.stl: what\rit is; what to do"); });
    EXPECT_EQ(error.code, static_cast<int>(code));
    EXPECT_EQ(error.words, "standoff: error: a.stl: what it is; what to do\n");
  }
  const Told device = told([] { throw Error(ErrorCode::device, "cuda: no GPU; use the CPU"); });
  EXPECT_EQ(device.code, 6);
  EXPECT_EQ(device.words,
            "standoff: error: cuda: no GPU; use the CPU (standoff devices lists what there is; --device cpu takes the "
            "CPU)\n");
  const Told interrupted = told([] { throw Error(ErrorCode::interrupted, "compute: cancelled"); });
  EXPECT_EQ(interrupted.code, 130);
  EXPECT_EQ(interrupted.words, "standoff: error: interrupted; no partial file was left, run it again\n");
}

}  // namespace
}  // namespace standoff::cli
