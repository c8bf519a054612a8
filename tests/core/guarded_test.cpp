// SPDX-License-Identifier: Apache-2.0
// What foreign exceptions become, and that the caller's own pass as they are.
#include "core/guarded.h"

#include <gtest/gtest.h>

#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "standoff/error.h"

namespace standoff {
namespace {

void guarded(const std::function<void()>& call) try { call(); } catch (...) {
  throw_as_error("place", "do something else");
}

Error error_of(const std::function<void()>& call) {
  try {
    guarded(call);
  } catch (const Error& error) {
    return error;
  }
  return {ErrorCode::usage, "nothing was thrown"};
}

TEST(Guarded, MakesEverythingAnError) {
  const std::string refused =
      error_of([] { throw std::system_error(std::make_error_code(std::errc::timed_out)); }).what();
  EXPECT_TRUE(refused.starts_with("place: the system refused: ")) << refused;
  EXPECT_STREQ(error_of([] { throw std::bad_alloc(); }).what(), "place: not enough memory; do something else");
  EXPECT_EQ(error_of([] { throw std::length_error("too long"); }).code(), ErrorCode::limit);
  EXPECT_EQ(error_of([] { throw std::logic_error("a bug"); }).code(), ErrorCode::internal);
  EXPECT_EQ(error_of([] { throw 7; }).code(), ErrorCode::internal);
}

TEST(Guarded, LeavesErrorsAndTheCallersOwn) {
  const Error kept = error_of([] { throw Error(ErrorCode::device, "as it was"); });
  EXPECT_EQ(kept.code(), ErrorCode::device);
  EXPECT_STREQ(kept.what(), "as it was");
  EXPECT_THROW(guarded([] { call_back([] { throw 7; }); }), int);
}

}  // namespace
}  // namespace standoff
