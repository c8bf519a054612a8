// SPDX-License-Identifier: Apache-2.0
#include "files/text.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "files/file_view.h"

namespace standoff {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  while (!(text = trimmed(text)).empty()) {
    const auto end = static_cast<std::size_t>(std::ranges::find_if(text, is_space) - text.begin());
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return words;
}

std::string escaped(std::string_view value) {
  std::string text;
  for (const char c : value) text += c == '\n' ? "\\n" : c == '\\' ? "\\\\" : std::string(1, c);
  return text;
}

std::string unescaped(std::string_view text) {
  std::string value;
  for (std::size_t n = 0; n < text.size(); ++n) {
    const bool escape = text[n] == '\\' && n + 1 < text.size();
    if (escape) ++n;
    value += escape && text[n] == 'n' ? '\n' : text[n];
  }
  return value;
}

bool equals_ignoring_case(std::string_view text, std::string_view lower) {
  return std::equal(text.begin(), text.end(), lower.begin(), lower.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

double beyond_range(std::string_view text) {
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  const std::string_view digits = text.substr(0, e);
  const auto point = static_cast<std::int64_t>(std::min(digits.find('.'), digits.size()));
  const auto first = static_cast<std::int64_t>(std::min(digits.find_first_of("123456789"), digits.size()));
  const std::int64_t power = first < point ? point - first - 1 : point - first;  // of ten, of the first digit but 0
  std::string_view written = text.substr(std::min(e + 1, text.size()));
  if (written.starts_with('+')) written.remove_prefix(1);
  std::int64_t exponent = 0;
  const auto error = std::from_chars(written.data(), written.data() + written.size(), exponent).ec;
  const bool small = error == std::errc::result_out_of_range ? written[0] == '-' : exponent < -power;
  return small ? 0 : std::numeric_limits<double>::infinity();
}

bool TextCursor::continues(const char* place) const {
  return end_ - place >= 2 && place[0] == '\\' && is_line_end(place[1]);
}

std::string_view TextCursor::statement_word() {
  skip_blanks();
  const char* begin = at_;
  skip_word();
  return {begin, static_cast<std::size_t>(at_ - begin)};
}

void TextCursor::skip_blanks() {
  for (;;) {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    if (!continues(at_)) return;
    ++at_;
    skip_line();
  }
}

void TextCursor::skip_line() {
  step();
  while (at_ != end_ && !is_line_end(*at_)) ++at_;
  take('\r');
  take('\n');
}

void TextCursor::skip_statement() {
  for (;;) {
    const char* begin = at_;
    while (at_ != end_ && !is_line_end(*at_)) ++at_;
    const bool continued = at_ != end_ && at_ != begin && at_[-1] == '\\';
    skip_line();
    if (!continued) return;
  }
}

template <class Number>
Number TextCursor::number() {
  step();
  constexpr bool integral = std::is_integral_v<Number>;
  const char* wanted = integral ? "a whole number" : "a number";
  // std::from_chars knows no plus.
  const bool plus = end_ - at_ > 1 && at_[0] == '+' && at_[1] != '-';
  Number value{};
  const auto [stop, error] = std::from_chars(at_ + plus, end_, value);
  if (error == std::errc::invalid_argument || !ends_word(stop)) fail_number(at_, wanted);
  if (error == std::errc::result_out_of_range) {
    if constexpr (integral) {
      fail_number(at_, "a smaller number");
    } else {
      // What is infinite is left to the check of all vertices.
      value = static_cast<Number>(beyond_range({at_, static_cast<std::size_t>(stop - at_)}));
    }
  }
  at_ = stop;
  return value;
}

template double TextCursor::number<double>();
template float TextCursor::number<float>();
template std::int64_t TextCursor::number<std::int64_t>();

std::int64_t TextCursor::integer_prefix() {
  step();
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(at_, end_, value);
  if (error != std::errc{}) fail_number(at_, "a whole number");
  at_ = stop;
  return value;
}

void TextCursor::fail_number(const char* begin, const char* wanted) const {
  const char* stop = std::find_if(begin, end_, is_space);
  if (begin == stop) fail_at(begin, std::string(wanted) + " is missing; the file is cut off or damaged, get all of it");
  fail_at(begin, "expected " + std::string(wanted) + ", found " +
                     in_quotes({begin, static_cast<std::size_t>(stop - begin)}) +
                     "; write numbers like 12 or -1.5e3, decimals with a point");
}

std::uint64_t TextCursor::line_at(const char* place) const {
  std::uint64_t line = 1;
  for (const char* c = file_.bytes().data(); c != place; ++c)
    line += *c == '\n' || (*c == '\r' && (c + 1 == end_ || c[1] != '\n'));
  return line;
}

void TextCursor::fail_at(const char* place, const std::string& message) const {
  file_.fail("line " + std::to_string(line_at(place)), message);
}

namespace {

// Takes `name = "value"` off the front; false at the end and where there is none.
bool take_attribute(std::string_view& text, std::string_view& name, std::string_view& value) {
  const auto skip = [&] {
    while (!text.empty() && is_space(text[0])) text.remove_prefix(1);
  };
  skip();
  const auto length = static_cast<std::size_t>(
      std::find_if(text.begin(), text.end(), [](char c) { return is_space(c) || c == '='; }) - text.begin());
  name = text.substr(0, length);
  text.remove_prefix(length);
  skip();
  if (name.empty() || !text.starts_with('=')) return false;
  text.remove_prefix(1);
  skip();
  if (text.empty() || (text[0] != '"' && text[0] != '\'')) return false;
  const auto end = text.find(text[0], 1);
  if (end == text.npos) return false;
  value = text.substr(1, end - 1);
  text.remove_prefix(end + 1);
  return true;
}

// What #233 or #xe9 stands for, in UTF-8.
bool add_character(std::string_view name, std::string& text) {
  if (!name.starts_with('#')) return false;
  name.remove_prefix(1);
  const int base = name.starts_with('x') ? 16 : 10;
  if (base == 16) name.remove_prefix(1);
  std::uint32_t code = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), code, base);
  if (error != std::errc{} || end != name.data() + name.size() || code > 0x10ffff) return false;
  const int more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;  // bytes after the first
  constexpr std::uint32_t kFirst[] = {0, 0xc0, 0xe0, 0xf0};
  text += static_cast<char>(kFirst[more] | code >> (6 * more));
  for (int n = more; n-- > 0;) text += static_cast<char>(0x80 | (code >> (6 * n) & 0x3f));
  return true;
}

}  // namespace

std::optional<std::string_view> XmlTag::find(std::string_view wanted) const {
  std::string_view rest = attributes, found, value;
  while (take_attribute(rest, found, value))
    if (found == wanted) return value;
  return std::nullopt;
}

std::optional<std::string_view> XmlTag::find_local(std::string_view wanted) const {
  std::string_view rest = attributes, found, value;
  while (take_attribute(rest, found, value))
    if (found.substr(found.rfind(':') + 1) == wanted) return value;
  return std::nullopt;
}

XmlScan::XmlScan(const FileView& file, std::string_view text) : file_(file), text_(text) {
  if (const auto zero = text_.find('\0'); zero != text_.npos)
    file.fail("byte " + std::to_string(place(text_.data() + zero)), "a zero byte; the text must be UTF-8, convert it");
}

std::size_t XmlScan::place(const char* character) const {
  return static_cast<std::size_t>(character - file_.bytes().data());
}

void XmlScan::fail(const std::string& message) const {
  if (tag_ == text_.size()) file_.fail("", message);
  TextCursor(file_, place(text_.data() + tag_)).fail(message);
}

void XmlScan::fail_at(const XmlTag& tag, const std::string& message) const {
  TextCursor(file_, place(tag.name.data())).fail(message);
}

bool XmlScan::next(XmlTag& tag) {
  if (++steps_ % 4096 == 0) file_.check();
  for (;;) {
    tag_ = at_ = std::min(text_.find('<', at_), text_.size());
    const std::string_view rest = text_.substr(at_);
    if (rest.empty()) return false;
    if (rest.starts_with("<!--")) {
      at_ += 4;
      skip_past("-->");
    } else if (rest.starts_with("<![CDATA[")) {
      skip_past("]]>");
    } else if (rest.starts_with("<?")) {
      skip_past("?>");
    } else if (rest.starts_with("<!")) {
      fail("a document type is not read here; remove it");
    } else {
      tag = read_tag();
      return true;
    }
  }
}

void XmlScan::skip_past(std::string_view end) {
  const auto found = text_.find(end, at_);
  if (found == text_.npos) fail("a comment or section without an end; the file is cut off or damaged, get all of it");
  at_ = found + end.size();
}

XmlTag XmlScan::read_tag() {
  const bool close = text_.substr(at_ + 1).starts_with('/');
  const std::size_t begin = at_ + 1 + close;
  char quote = 0;
  for (at_ = begin; at_ < text_.size() && (quote || text_[at_] != '>'); ++at_) {
    const char c = text_[at_];
    if (quote)
      quote = c == quote ? '\0' : quote;
    else if (c == '"' || c == '\'')
      quote = c;
    else if (c == '<')
      fail("a tag inside a tag; repair the file");
  }
  if (at_ == text_.size()) fail("a tag without an end; the file is cut off or damaged, get all of it");
  std::string_view inside = text_.substr(begin, at_ - begin);
  ++at_;
  XmlTag tag{close ? XmlTag::Kind::close : XmlTag::Kind::open, {}, {}, {}, false};
  if (!close && inside.ends_with('/')) {
    tag.kind = XmlTag::Kind::whole;
    inside.remove_suffix(1);
  }
  const auto name_end = static_cast<std::size_t>(std::find_if(inside.begin(), inside.end(), is_space) - inside.begin());
  tag.name = inside.substr(0, name_end);
  tag.attributes = inside.substr(name_end);
  std::string_view rest = tag.attributes, name, value;
  while (take_attribute(rest, name, value)) {
  }
  if (tag.name.empty() || std::find_if_not(rest.begin(), rest.end(), is_space) != rest.end() || !name.empty())
    fail("a damaged tag; repair the file");
  tag.text = text_.substr(at_, text_.find('<', at_) - at_);
  tag.only_text = text_.substr(at_ + tag.text.size()).starts_with("</");
  return tag;
}

bool XmlElements::next(const XmlTag& parent, XmlTag& tag) {
  if (!scan_.next(tag))
    scan_.fail_at(parent, "the element " + shown(parent.local_name()) +
                              " has no end; the file is cut off or damaged, get all of it");
  if (tag.opens()) return true;
  if (tag.name != parent.name)
    scan_.fail("the element " + shown(parent.local_name()) + " ends as " + shown(tag.local_name()) +
               "; repair the file");
  return false;
}

void XmlElements::fail_depth() const {
  scan_.fail("elements nested more than " + std::to_string(deepest_) + " deep; " + remedy_);
}

std::string plain_xml(std::string_view text) {
  constexpr std::pair<std::string_view, char> kNamed[] = {
      {"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}};
  std::string plain;
  plain.reserve(text.size());
  while (!text.empty()) {
    const char c = text[0];
    const std::size_t end = c == '&' ? text.substr(0, 12).find(';') : text.npos;
    if (end == text.npos) {
      plain += is_space(c) ? ' ' : c;
      text.remove_prefix(1);
      continue;
    }
    const std::string_view name = text.substr(1, end - 1);
    const auto* found = std::ranges::find(kNamed, name, [](const auto& pair) { return pair.first; });
    if (found != std::end(kNamed))
      plain += found->second;
    else if (!add_character(name, plain))
      plain += text.substr(0, end + 1);
    text.remove_prefix(end + 1);
  }
  return plain;
}

}  // namespace standoff
