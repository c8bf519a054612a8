// SPDX-License-Identifier: Apache-2.0
// Words and numbers of text formats, and the tags of XML, with the line they stand in.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_view.h"

namespace standoff {

constexpr bool is_line_end(char c) { return c == '\n' || c == '\r'; }
constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
constexpr bool is_space(char c) { return is_blank(c) || is_line_end(c); }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Takes spaces off the front.
constexpr void skip_space(std::string_view& text) {
  while (!text.empty() && is_space(text[0])) text.remove_prefix(1);
}

/// The text without spaces at its ends.
std::string_view trimmed(std::string_view text);
/// The parts between spaces.
std::vector<std::string_view> words_of(std::string_view text);

/// A value on one line of a header: \n stands for a line break, \\ for a backslash.
std::string escaped(std::string_view value);
std::string unescaped(std::string_view text);

/// Equal but for the case of ASCII letters. `lower` is in lower case.
bool equals_ignoring_case(std::string_view text, std::string_view lower);

/// What becomes of a number that std::from_chars found to be out of range: zero where it is too small, infinite where
/// it is too large. `text` is the number alone, in decimal.
double beyond_range(std::string_view text);

/// A place in a text. Lines end with LF, CR LF or CR; numbers are as std::from_chars reads them, in any locale, with an
/// optional leading plus. Every failure throws Error{input} that names the line.
class TextCursor {
 public:
  explicit TextCursor(const FileView& file, std::size_t begin = 0)
      : file_(file), at_(file.bytes().data() + begin), end_(file.bytes().data() + file.size()) {}

  bool at_end() const { return at_ == end_; }
  std::size_t offset() const { return static_cast<std::size_t>(at_ - file_.bytes().data()); }
  const char* position() const { return at_; }
  /// Characters to the end of the text.
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }

  /// Skips spaces and line ends.
  void skip_space() {
    while (at_ != end_ && is_space(*at_)) ++at_;
  }
  /// Skips spaces of the current line, which a backslash at its end continues on the next.
  void skip_blanks();
  bool at_word_end() const { return ends_word(at_); }
  /// True at the end of a line or of the text.
  bool at_line_end() const { return at_ == end_ || is_line_end(*at_); }
  /// Skips the rest of the line and its end. Backslashes mean nothing here.
  void skip_line();
  /// Skips the rest of the line, with the lines that continue it, and its end.
  void skip_statement();

  /// Takes the characters up to the next space. Empty at a space and at the end.
  std::string_view word() {
    const char* begin = at_;
    while (at_ != end_ && !is_space(*at_)) ++at_;
    return {begin, static_cast<std::size_t>(at_ - begin)};
  }
  /// Skips the characters up to the next space or continued line end.
  void skip_word() {
    while (!ends_word(at_)) ++at_;
  }
  /// Skips blanks of the line, then takes the characters up to the next space or continued line end.
  std::string_view statement_word();
  /// Skips spaces and line ends, then takes a word.
  std::string_view next_word() {
    skip_space();
    return word();
  }

  /// Takes the number here, up to a space, as a double, a float (rounded once from the text) or a 64-bit integer.
  template <class Number>
  Number number();
  /// Takes the integer here, and nothing after it.
  std::int64_t integer_prefix();
  /// Steps over `c` if it stands here.
  bool take(char c) {
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }

  /// The line of the cursor, from 1 on. Linear in the text before it.
  std::uint64_t line() const { return line_at(at_); }
  /// Throws with the line of the cursor, or of another place in the text.
  [[noreturn]] void fail(const std::string& message) const { fail_at(at_, message); }
  [[noreturn]] void fail_at(const char* place, const std::string& message) const;

 private:
  // Lets the caller who waits for the file stop, once in many calls.
  void step() {
    if (++steps_ % 4096 == 0) file_.check();
  }
  bool continues(const char* place) const;
  bool ends_word(const char* place) const { return place == end_ || is_space(*place) || continues(place); }
  std::uint64_t line_at(const char* place) const;
  [[noreturn]] void fail_number(const char* begin, const char* wanted) const;

  const FileView& file_;
  const char* at_;
  const char* end_;
  std::uint32_t steps_ = 0;
};

extern template double TextCursor::number<double>();
extern template float TextCursor::number<float>();
extern template std::int64_t TextCursor::number<std::int64_t>();

struct XmlTag {
  enum class Kind { open, close, whole };  ///< <a>, </a>, <a/>
  Kind kind;
  std::string_view name;
  std::string_view attributes;  ///< as written
  std::string_view text;        ///< what follows, up to the next tag or comment
  bool only_text;               ///< what ends the text is a closing tag

  /// The value of an attribute as written, or nothing. The first one counts.
  std::optional<std::string_view> find(std::string_view attribute) const;
  /// The same, empty where the attribute is missing.
  std::string_view attribute(std::string_view wanted) const { return find(wanted).value_or(std::string_view()); }
  /// The value of an attribute whatever stands before the colon of its name: of `path`, that of p:path too.
  std::optional<std::string_view> find_local(std::string_view attribute) const;
  /// The name without what stands before its colon.
  std::string_view local_name() const { return name.substr(name.rfind(':') + 1); }
  /// Opens an element: <a> or <a/>.
  bool opens() const { return kind != Kind::close; }
};

/// Reads UTF-8 without document types; comments, CDATA and instructions are passed over. Checks the form of tags only,
/// not that they match. Nothing is copied: tags point into the file. Errors: input, with the line.
class XmlScan {
 public:
  explicit XmlScan(const FileView& file) : XmlScan(file, file.bytes()) {}
  /// Scans `text` alone, a part of the file's bytes.
  XmlScan(const FileView& file, std::string_view text);

  /// False at the end.
  bool next(XmlTag& tag);
  /// Throws with the line of the tag read last, or after the end without one.
  [[noreturn]] void fail(const std::string& message) const;
  /// Throws with the line of a tag read before.
  [[noreturn]] void fail_at(const XmlTag& tag, const std::string& message) const;

 private:
  std::size_t place(const char* character) const;
  void skip_past(std::string_view end);
  XmlTag read_tag();

  const FileView& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t tag_ = 0;
  std::size_t steps_ = 0;
};

/// Goes through the elements of a text by their nesting. Errors: input, with the line, where tags do not match or are
/// nested deeper than `deepest`; `remedy` says what to do then.
class XmlElements {
 public:
  XmlElements(XmlScan& scan, int deepest, const char* remedy) : scan_(scan), deepest_(deepest), remedy_(remedy) {}

  /// Calls visit(tag) for each element in another one. It must read what is in there: each_child() or skip().
  template <class Visit>
  void each_child(const XmlTag& parent, const Visit& visit) {
    if (parent.kind == XmlTag::Kind::whole) return;
    if (++depth_ > deepest_) fail_depth();
    XmlTag tag{};
    while (next(parent, tag)) visit(tag);
    --depth_;
  }
  void skip(const XmlTag& tag) {
    each_child(tag, [this](const XmlTag& child) { skip(child); });
  }

 private:
  // False where the parent ends.
  bool next(const XmlTag& parent, XmlTag& tag);
  [[noreturn]] void fail_depth() const;

  XmlScan& scan_;
  int deepest_, depth_ = 0;
  const char* remedy_;
};

/// Text between tags or of an attribute, where &lt; and the like stand for characters, and line ends for spaces.
std::string plain_xml(std::string_view text);

}  // namespace standoff
