// SPDX-License-Identifier: Apache-2.0
// Numbers and lines of text formats.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "files/text.h"
#include "standoff/error.h"
#include "tests/support/comma_locale.h"

namespace standoff {
namespace {

template <class Number>
Number parsed(const std::string& text) {
  const FileView file("text", text);
  return TextCursor(file).number<Number>();
}

std::string message(const std::string& text) {
  try {
    parsed<double>(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(MeshText, ReadsNumbersExactly) {
  EXPECT_EQ(parsed<double>("0.1"), 0.1);
  EXPECT_EQ(parsed<double>("+1.5E+3 "), 1500);
  EXPECT_EQ(parsed<double>("-.25\n"), -0.25);
  EXPECT_EQ(parsed<double>("7."), 7);
  EXPECT_EQ(parsed<double>("9007199254740993"), 9007199254740992);  // a tie goes to even
  EXPECT_EQ(parsed<double>("9007199254740993.0000000000000000000000000000001"), 9007199254740994);
  EXPECT_EQ(parsed<double>("4.9406564584124654e-324"), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(parsed<double>("1.7976931348623157e308"), std::numeric_limits<double>::max());
  EXPECT_EQ(parsed<std::int64_t>("-9223372036854775808"), std::numeric_limits<std::int64_t>::min());
}

// Through double, this text would round to 1 first and stay there: the nearest float is the one above.
TEST(MeshText, RoundsFloatsOnce) {
  const std::string just_above_half = "1.000000059604644775390626";
  EXPECT_EQ(parsed<float>(just_above_half), std::nextafter(1.0f, 2.0f));
  EXPECT_EQ(static_cast<float>(parsed<double>(just_above_half)), 1.0f);
}

TEST(MeshText, NumbersOutOfRangeBecomeZeroOrInfinite) {
  EXPECT_EQ(parsed<double>("1e-400"), 0);
  EXPECT_EQ(parsed<double>("0." + std::string(400, '0') + "1"), 0);
  EXPECT_TRUE(std::isinf(parsed<double>("1e400")));
  EXPECT_TRUE(std::isinf(parsed<double>("-1e400")));
  EXPECT_TRUE(std::isinf(parsed<double>("1" + std::string(400, '0'))));
  EXPECT_TRUE(std::isinf(parsed<float>("1e39")));
  // Neither the sign of the exponent nor the digits tell alone.
  EXPECT_EQ(parsed<double>("0." + std::string(400, '0') + "1e+50"), 0);
  EXPECT_TRUE(std::isinf(parsed<double>("-1" + std::string(400, '0') + ".5E-50")));
  EXPECT_EQ(parsed<double>("1e-99999999999999999999"), 0);
  EXPECT_TRUE(std::isinf(parsed<double>("1e+99999999999999999999")));
  EXPECT_TRUE(std::isnan(parsed<double>("nan")));
}

TEST(MeshText, RefusesWhatIsNoNumber) {
  for (const char* text : {"x", "1x", "1,5", "--1", "+-1", "1e", "0x10", "1.#QNAN", "."})
    EXPECT_NE(message(text), "") << text;
  EXPECT_EQ(message("1\x01\xff 2"),
            "text:line 1: expected a number, found '1\?\?'; write numbers like 12 or -1.5e3, "
            "decimals with a point");
  EXPECT_NE(message("").find("a number is missing"), std::string::npos);
  EXPECT_THROW(parsed<std::int64_t>("1.5"), Error);
  EXPECT_THROW(parsed<std::int64_t>("9223372036854775808"), Error);
}

TEST(MeshText, DoesNotAskTheLocale) {
  const CommaLocale locale;
  if (!locale.is_set()) GTEST_SKIP() << "no localedef here";
  EXPECT_EQ(parsed<double>("1.5"), 1.5);
}

TEST(MeshText, CountsLinesOfEveryKind) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const FileView file("text", "");
    const std::string text = "one" + end + end + "three" + end + "four";
    const FileView lines("text", text);
    TextCursor cursor(lines);
    for (const auto& [word, line] : {std::pair{"one", 1u}, {"three", 3u}, {"four", 4u}}) {
      EXPECT_EQ(cursor.next_word(), word);
      EXPECT_EQ(cursor.line(), line);
    }
    EXPECT_EQ(cursor.next_word(), "");
  }
}

TEST(MeshText, BackslashesContinueStatements) {
  const FileView file("text", "a \\\n b\\\r\nc d\\ e\nnext");
  TextCursor cursor(file);
  for (const char* word : {"a", "b", "c", "d\\", "e"}) EXPECT_EQ(cursor.statement_word(), word);
  EXPECT_TRUE(cursor.at_line_end());
  TextCursor other(file);
  other.skip_statement();
  EXPECT_EQ(other.statement_word(), "next");
}

}  // namespace
}  // namespace standoff
