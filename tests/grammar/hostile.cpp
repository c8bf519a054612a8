// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/hostile.h"

#include <array>
#include <charconv>

#include "tests/grammar/file.h"

namespace standoff::grammar {

std::string bad_number(Choices& c) {
  switch (c.below(8)) {
    case 0:
      return std::string(c.many(), c.one_in(2) ? '9' : '0');
    case 1:
      return "1" + std::string(c.many(), '0') + "." + std::string(c.many(), '0') + "e-" + std::string(c.many(), '9');
    case 2:
      return std::to_string(c.below(64)) + std::string(c.many(), ' ');
    case 3:
      return std::to_string(std::uint64_t{1} << c.below(64));
    default: {
      constexpr const char* kWords[] = {"-1",
                                        "0",
                                        "1",
                                        "255",
                                        "65535",
                                        "65536",
                                        "16777217",
                                        "2147483647",
                                        "2147483648",
                                        "4294967295",
                                        "4294967296",
                                        "9223372036854775807",
                                        "9223372036854775808",
                                        "18446744073709551615",
                                        "18446744073709551616",
                                        "-2147483648",
                                        "-9223372036854775808",
                                        "1e30",
                                        "1e308",
                                        "1e309",
                                        "-1e-320",
                                        "1.5",
                                        "nan",
                                        "-nan",
                                        "inf",
                                        "-infinity",
                                        "NaN(12)",
                                        "0x10",
                                        "1e",
                                        "+",
                                        "-",
                                        ".",
                                        "--1",
                                        "+-1",
                                        "1,5",
                                        "1_000",
                                        "",
                                        "null",
                                        "\xd9\xa1"};
      return c.pick(kWords);
    }
  }
}

std::string bad_path(Choices& c) {
  constexpr const char* kPaths[] = {kPipe,
                                    kFolder,
                                    kLoop,
                                    kOutside,
                                    "/dev/zero",
                                    "/dev/tty",
                                    "/dev/stdin",
                                    "/proc/self/mem",
                                    "/etc/passwd",
                                    "../../../../../../etc/passwd",
                                    "./././pipe.bin",
                                    "folder.bin/../pipe.bin",
                                    "%2e%2e/outside.bin",
                                    "..%2foutside.bin",
                                    "..\\outside.bin",
                                    "file:///dev/zero",
                                    "http://localhost:1/a.bin",
                                    "missing.bin",
                                    "",
                                    ".",
                                    "..",
                                    "~",
                                    "|cat",
                                    "a.bin?b#c",
                                    "data:,",
                                    "data:;base64,"};
  return c.one_in(12) ? std::string(c.many(), 'a') : c.pick(kPaths);
}

std::string whole(Choices& c, std::int64_t value) { return c.trick() ? bad_number(c) : std::to_string(value); }

std::string real(Choices& c, double value) {
  if (c.trick()) return bad_number(c);
  constexpr std::chars_format kForms[] = {std::chars_format::general, std::chars_format::fixed,
                                          std::chars_format::scientific};
  std::array<char, 400> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, c.pick(kForms)).ptr;
  return {text.data(), end};
}

std::string word(Choices& c, const std::string& plain) {
  if (!c.trick()) return plain;
  switch (c.below(9)) {
    case 0:
      return "";
    case 1:
      return std::string(c.many(), 'x');
    case 2:
      return plain + '\0' + plain;
    case 3:
      return plain + " " + plain;
    case 4:
      return "\xff\xfe\xc0\x80" + plain;
    case 5:
      return plain.substr(0, plain.size() / 2);
    case 6:
      return plain + "\"'<>&;%n%s\\";
    case 7:
      return bad_number(c);
    default: {
      std::string changed = plain;
      for (char& letter : changed) letter = letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 32) : letter;
      return changed;
    }
  }
}

std::string noise(Choices& c) {
  if (!c.trick()) return "";
  constexpr const char* kNoise[] = {"\r",           "\n\n\n", "\\\n", "#",   "# \\\n", "\t\v\f ", "\x1a",
                                    "\xef\xbb\xbf", " {} ",   "<!--", "-->", "\"",     "]]>",     "\xc2\xa0"};
  switch (c.below(4)) {
    case 0:
      return std::string(1, '\0');
    case 1:
      return std::string(c.many(), c.one_in(2) ? ' ' : '\n');
    default:
      return c.pick(kNoise);
  }
}

void damage(Choices& c, std::string& bytes) {
  for (int edits = 0; edits < 4 && !bytes.empty() && c.trick(); ++edits) {
    const std::size_t at = c.below(static_cast<std::uint32_t>(bytes.size()));
    switch (c.below(6)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.erase(at, 1 + c.below(64));
        break;
      case 2:
        bytes.insert(at, bytes.substr(c.below(static_cast<std::uint32_t>(bytes.size())), 1 + c.below(256)));
        break;
      case 3:
        bytes[at] = static_cast<char>(c.below(256));
        break;
      case 4:
        bytes += bytes.substr(at);
        break;
      default:
        bytes += std::string(c.many(), static_cast<char>(c.below(256)));
        break;
    }
  }
}

}  // namespace standoff::grammar
