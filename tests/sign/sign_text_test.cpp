// SPDX-License-Identifier: Apache-2.0
#include "sign/sign_text.h"

#include <gtest/gtest.h>

#include "tests/support/comma_locale.h"

namespace standoff {
namespace {

TEST(SignText, EveryTextIsReadBack) {
  std::set<std::string> texts;
  for (const auto method : {SignMethod::winding, SignMethod::parity, SignMethod::normal, SignMethod::flood})
    for (const auto rule : {WindingRule::positive, WindingRule::nonzero, WindingRule::odd})
      for (const bool invert : {false, true})
        for (const bool oriented : {false, true}) {
          const SignText text{method, rule, invert, oriented};
          texts.insert(written(text));
          EXPECT_EQ(sign_text_in(written(text)), text) << written(text);
        }
  EXPECT_EQ(texts.size(), 48u);
  const SignText outer{.method = SignMethod::winding, .rule = WindingRule::odd, .oriented = true, .outer = true};
  EXPECT_EQ(written(outer), "winding odd oriented outer");
  EXPECT_EQ(sign_text_in(written(outer)), outer);
  EXPECT_EQ(sign_text_in("parity outer"), std::nullopt);
  for (const double shell : {0.01, 1.0 / 3, 5e-324, 1e300}) {
    const SignText text{.method = SignMethod::shell, .shell = shell};
    EXPECT_EQ(sign_text_in(written(text)), text) << written(text);
  }
}

TEST(SignText, TextsOfFilesStayReadable) {
  EXPECT_EQ(written({}), "");
  EXPECT_EQ(written({SignMethod::winding}), "winding");
  EXPECT_EQ(written({SignMethod::parity}), "parity");
  EXPECT_EQ(written({SignMethod::winding, WindingRule::odd, true, true}), "winding odd oriented inverted");
  EXPECT_EQ(written({.method = SignMethod::shell, .shell = 0.01}), "shell 0.01");
  const CommaLocale locale;
  EXPECT_EQ(written({.method = SignMethod::shell, .shell = 0.01}), "shell 0.01");
}

TEST(SignText, OtherTextsAreNotGuessedAt) {
  for (const char* text : {"",
                           " ",
                           "none",
                           "auto",
                           "Winding",
                           "winding ",
                           " winding",
                           "winding  odd",
                           "winding inverted odd",
                           "winding odd odd",
                           "winding odd nonzero",
                           "winding 0.01",
                           "winding sideways",
                           "parity even",
                           "shell",
                           "shell 0",
                           "shell -1",
                           "shell inf",
                           "shell nan",
                           "shell 1 2",

                           "shell 0,01",
                           "flood\n",
                           "by a neural network"})
    EXPECT_FALSE(sign_text_in(text)) << "'" << text << "'";
}

TEST(SignText, SaysWhatWasDone) {
  const SignOptions options{.method = SignMethod::automatic, .rule = WindingRule::nonzero, .invert = true, .shell = 2};
  const auto text = [&](SignMethod used, std::int64_t flipped) {
    SignReport report{.method = used, .flipped = flipped};
    return written(sign_text_of(options, report));
  };
  EXPECT_EQ(text(SignMethod::winding, 0), "winding nonzero inverted");
  EXPECT_EQ(text(SignMethod::none, 0), "");
  EXPECT_EQ(text(SignMethod::flood, 3), "flood oriented inverted");
  SignReport left_out{.method = SignMethod::parity, .left_out = 2};
  EXPECT_EQ(written(sign_text_of(options, left_out)), "parity oriented inverted");
  EXPECT_EQ(text(SignMethod::shell, 0), "shell 2 inverted");
}

}  // namespace
}  // namespace standoff
