// SPDX-License-Identifier: Apache-2.0
#include "files/json_view.h"

#include <algorithm>
#include <charconv>

#include "files/text.h"

namespace standoff {
namespace {

constexpr const char* kAgain = "; write the file again in the program that made it";

constexpr bool is_json_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::size_t past_space(std::string_view text, std::size_t at) {
  while (at < text.size() && is_json_space(text[at])) ++at;
  return at;
}

// The byte after the string that begins at `at`, or npos. A quote ends it if the backslashes before it pair off.
std::size_t string_end(std::string_view text, std::size_t at) {
  for (std::size_t quote = text.find('"', at + 1); quote != text.npos; quote = text.find('"', quote + 1)) {
    std::size_t first = quote;
    while (first > at + 1 && text[first - 1] == '\\') --first;
    if ((quote - first) % 2 == 0) return quote + 1;
  }
  return text.npos;
}

// The byte after the value that begins at `at`, of text that was checked.
std::size_t value_end(std::string_view text, std::size_t at) {
  constexpr std::string_view kAfterWord = ",]} \t\r\n";
  int depth = 0;
  do {
    const char c = text[at];
    if (c == '"') {
      at = string_end(text, at);
    } else if (c == '{' || c == '[') {
      ++depth, ++at;
    } else if (c == '}' || c == ']') {
      --depth, ++at;
    } else if (depth > 0) {
      ++at;
    } else {
      at = std::min(text.find_first_of(kAfterWord, at), text.size());
    }
  } while (depth > 0);
  return at;
}

// As the grammar has it, which knows no plus, no leading zeros, no point without digits.
bool is_number(std::string_view word) {
  std::size_t at = word.starts_with('-');
  const auto digits = [&] {
    const std::size_t begin = at;
    while (at < word.size() && is_digit(word[at])) ++at;
    return at > begin;
  };
  if (at < word.size() && word[at] == '0')
    ++at;
  else if (!digits())
    return false;
  if (at < word.size() && word[at] == '.' && (++at, !digits())) return false;
  if (at < word.size() && (word[at] == 'e' || word[at] == 'E')) {
    ++at;
    if (at < word.size() && (word[at] == '+' || word[at] == '-')) ++at;
    if (!digits()) return false;
  }
  return at == word.size();
}

void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&text](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return put(code);
  if (code < 0x800) {
    put(0xc0 | code >> 6);
  } else {
    if (code < 0x10000) {
      put(0xe0 | code >> 12);
    } else {
      put(0xf0 | code >> 18);
      put(0x80 | (code >> 12 & 0x3f));
    }
    put(0x80 | (code >> 6 & 0x3f));
  }
  put(0x80 | (code & 0x3f));
}

// The number of the four hexadecimal digits after "\u", which begins at `at`; or nothing.
std::optional<std::uint32_t> utf16_unit(std::string_view text, std::size_t at) {
  std::uint32_t unit = 0;
  const std::string_view digits = text.substr(std::min(at, text.size()), 6);
  if (digits.size() < 6 || !digits.starts_with("\\u")) return {};
  const auto [after, error] = std::from_chars(digits.data() + 2, digits.data() + 6, unit, 16);
  if (error != std::errc{} || after != digits.data() + 6) return {};
  return unit;
}

}  // namespace

// Recursive descent over the grammar; keeps nothing.
class JsonView::Checker {
 public:
  Checker(const FileView& file, std::string_view text, int deepest) : file_(file), text_(text), deepest_(deepest) {}

  JsonView all() {
    const std::size_t begin = past_space(text_, at_);
    value();
    const std::size_t end = at_;
    if (next() != '\0') fail("text after its end");
    return {file_, text_.substr(begin, end - begin)};
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    JsonView(file_, text_.substr(std::min(at_, text_.size()))).fail("its JSON is damaged: " + what + kAgain);
  }
  // The next character that is no space; zero at the end.
  char next() {
    at_ = past_space(text_, at_);
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (next() != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail(std::string("no '") + c + "' where one should stand");
  }

  void string() {
    if (next() != '"') fail("no '\"' where one should stand");
    const std::size_t end = string_end(text_, at_);
    if (end == text_.npos) fail("a string without an end");
    at_ = end;
  }

  void value() {
    const char first = next();
    if ((first == '{' || first == '[') && ++depth_ > deepest_)
      JsonView(file_, text_.substr(at_))
          .fail("its JSON is nested more than " + std::to_string(deepest_) + " deep" + kAgain);
    if (take('{')) {
      if (!take('}')) {
        do {
          string();
          expect(':');
          value();
        } while (take(','));
        expect('}');
      }
      --depth_;
    } else if (take('[')) {
      if (!take(']')) {
        do value();
        while (take(','));
        expect(']');
      }
      --depth_;
    } else if (first == '"') {
      string();
    } else {
      word();
    }
  }

  void word() {
    const std::string_view word =
        text_.substr(at_, std::min(text_.find_first_of(",]} \t\r\n", at_), text_.size()) - at_);
    if (word.empty()) fail("a value is missing");
    if (word != "true" && word != "false" && word != "null" && !is_number(word)) fail(in_quotes(word) + " is no value");
    at_ += word.size();
  }

  const FileView& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  int deepest_, depth_ = 0;
};

JsonView JsonView::read(const FileView& file, std::string_view text, int deepest) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  text = text.substr(0, text.find('\0'));
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return Checker(file, text, deepest).all();
}

bool JsonView::Walk::next() {
  std::size_t at = past_space(rest_, 0);
  if (rest_[at] == ',' || rest_[at] == ':') at = past_space(rest_, at + 1);
  if (rest_[at] == ']' || rest_[at] == '}') return false;
  const std::size_t end = value_end(rest_, at);
  value_ = rest_.substr(at, end - at);
  rest_.remove_prefix(end);
  return true;
}

JsonView::Kind JsonView::kind() const {
  switch (text_[0]) {
    case '{':
      return Kind::object;
    case '[':
      return Kind::list;
    case '"':
      return Kind::string;
    default:
      return text_[0] == '-' || is_digit(text_[0]) ? Kind::number : Kind::literal;
  }
}

std::size_t JsonView::size() const {
  if (kind() != Kind::object) expect(Kind::list, "a list");  // nothing else ends where a walk looks for its end
  std::size_t values = 0;
  for (Walk walk(*this); walk.next();) ++values;
  return kind() == Kind::object ? values / 2 : values;
}

std::optional<JsonView> JsonView::find(std::string_view wanted) const {
  std::optional<JsonView> found;
  each_member([&](const std::string& name, const JsonView& value) {
    if (name != wanted) return;
    if (found) value.fail("a second member is called " + in_quotes(wanted) + "; remove one");
    found = value;
  });
  return found;
}

std::string JsonView::text() const {
  expect(Kind::string, "a string");
  const std::string_view written = text_.substr(1, text_.size() - 2);
  std::string text;
  for (std::size_t at = 0; at < written.size();) {
    const std::size_t escape = std::min(written.find('\\', at), written.size());
    text.append(written, at, escape - at);
    at = escape;
    if (at == written.size()) break;
    constexpr std::string_view kLetters = "\"\\/bfnrt", kMeant = "\"\\/\b\f\n\r\t";
    if (const auto letter = kLetters.find(written[at + 1]); letter != kLetters.npos) {
      text += kMeant[letter];
      at += 2;
      continue;
    }
    const auto unit = utf16_unit(written, at), low = utf16_unit(written, at + 6);
    if (!unit) fail(std::string("it holds an escape that JSON does not know") + kAgain);
    const bool pair = *unit >= 0xd800 && *unit < 0xdc00 && low && *low >= 0xdc00 && *low < 0xe000;
    append_utf8(text, pair ? 0x10000 + ((*unit - 0xd800) << 10) + (*low - 0xdc00) : *unit);
    at += pair ? 12 : 6;
  }
  return text;
}

std::uint64_t JsonView::whole() const {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 53;  // beyond it JSON's numbers are no longer whole
  std::uint64_t number = 0;
  const char* end = text_.data() + text_.size();
  const auto [after, error] = std::from_chars(text_.data(), end, number);
  if (error != std::errc{} || after != end || number > kMost)
    fail("expected a whole number from 0 on, found " + in_quotes(text_) + "; repair the file");
  return number;
}

double JsonView::number() const {
  expect(Kind::number, "a number");
  double number = 0;
  const auto [after, error] = std::from_chars(text_.data(), text_.data() + text_.size(), number);
  if (error == std::errc::result_out_of_range) return beyond_range(text_);
  return number;
}

bool JsonView::boolean() const {
  if (text_ != "true" && text_ != "false")
    fail("expected true or false, found " + in_quotes(text_) + "; repair the file");
  return text_ == "true";
}

void JsonView::fail(const std::string& what) const {
  file_->fail("byte " + std::to_string(text_.data() - file_->bytes().data()), what);
}

void JsonView::expect(Kind wanted, const char* name) const {
  if (kind() != wanted) fail(std::string("expected ") + name + ", found " + in_quotes(text_) + "; repair the file");
}

}  // namespace standoff
