// SPDX-License-Identifier: Apache-2.0
// What a failure must say.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "standoff/error.h"

namespace standoff {

/// Whether the end of a message, after its last "; ", tells the reader to do something.
inline bool says_what_to_do(const std::string& message) {
  const auto semicolon = message.rfind("; ");
  if (semicolon == message.npos) return false;
  const std::string advice = message.substr(semicolon);
  for (const char* verb :
       {"add",   "build", "check",       "choose", "convert", "create", "flatten", "get",      "give", "instance",
        "join",  "name",  "place",       "put",    "remove",  "rename", "repair",  "resample", "save", "scale",
        "split", "take",  "triangulate", "use",    "write",   "make",   "leave",   "unpack"})
    if (advice.find(std::string(" ") + verb + " ") != advice.npos) return true;
  return false;
}

/// The call must throw Error with the code and a message that holds the words; that of an input says what to do.
template <class Call>
void expect_error(Call call, ErrorCode code, const std::string& words) {
  try {
    call();
    ADD_FAILURE() << "no error; expected: " << words;
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.code()), static_cast<int>(code)) << error.what();
    EXPECT_TRUE(code != ErrorCode::input || says_what_to_do(error.what())) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what() << "\nlacks: " << words;
  }
}

}  // namespace standoff
