// What a failure must say.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "difi/error.h"

namespace difi {

/// The call must throw Error with the code and a message that holds the words.
template <class Call>
void expect_error(Call call, ErrorCode code, const std::string& words) {
  try {
    call();
    ADD_FAILURE() << "no error; expected: " << words;
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.code()), static_cast<int>(code)) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what() << "\nlacks: " << words;
  }
}

}  // namespace difi
