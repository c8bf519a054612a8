#include "io/json_view.h"

#include <algorithm>
#include <charconv>
#include <string>

namespace difi {

class JsonView::Reader {
 public:
  Reader(const FileView& file, std::string_view text, std::size_t offset, int deepest)
      : file_(file), text_(text), offset_(offset), deepest_(deepest) {}

  JsonView all() {
    JsonView read = value();
    if (next() != '\0') fail("text after its end");
    return read;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    file_.fail("byte " + std::to_string(offset_ + at_),
               "its JSON is damaged: " + what + "; write the file again in the program that made it");
  }

  // The next character that is no space; zero at the end.
  char next() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
      ++at_;
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

  std::string_view string() {
    expect('"');
    const std::size_t begin = at_;
    for (; at_ < text_.size() && text_[at_] != '"'; ++at_)
      if (text_[at_] == '\\') ++at_;
    if (at_ >= text_.size()) fail("a string without an end");
    return text_.substr(begin, at_++ - begin);
  }

  JsonView value() {
    JsonView read;
    const char first = next();
    if ((first == '{' || first == '[') && ++depth_ > deepest_)
      file_.fail("byte " + std::to_string(offset_ + at_),
                 "its JSON is nested more than " + std::to_string(deepest_) +
                     " deep; write the file again in the program that made it");
    if (take('{')) {
      if (!take('}')) {
        do {
          next();
          const std::string_view name = string();
          expect(':');
          read.members_.emplace_back(name, value());
        } while (take(','));
        expect('}');
      }
      --depth_;
    } else if (take('[')) {
      if (!take(']')) {
        do read.elements_.push_back(value());
        while (take(','));
        expect(']');
      }
      --depth_;
    } else if (first == '"') {
      read.text_ = string();
    } else {
      const std::size_t end = std::min(text_.find_first_of(",]} \t\r\n", at_), text_.size());
      read.word_ = text_.substr(at_, end - at_);
      if (read.word_.empty()) fail("a value is missing");
      at_ = end;
    }
    return read;
  }

  const FileView& file_;
  std::string_view text_;
  std::size_t offset_, at_ = 0;
  int deepest_, depth_ = 0;
};

JsonView JsonView::read(const FileView& file, std::string_view text, std::size_t offset, int deepest) {
  return Reader(file, text.substr(0, text.find('\0')), offset, deepest).all();
}

const JsonView* JsonView::find(std::string_view name) const {
  for (const auto& [member, value] : members_)
    if (member == name) return &value;
  return nullptr;
}

std::optional<std::uint32_t> JsonView::whole() const {
  std::uint32_t number = 0;
  const char* end = word_.data() + word_.size();
  const auto [after, error] = std::from_chars(word_.data(), end, number);
  if (error != std::errc{} || after != end) return {};
  return number;
}

}  // namespace difi
