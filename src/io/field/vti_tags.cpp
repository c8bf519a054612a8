#include "io/field/vti_tags.h"

#include <algorithm>

namespace standoff {
namespace {

constexpr std::string_view kSpace = " \t\r\n";
constexpr std::string_view kEndOfName = " \t\r\n=/>";

class Scanner {
 public:
  Scanner(const FieldInput& file, std::string_view text) : file_(file), text_(text) {}

  std::vector<VtiTag> tags() {
    std::vector<VtiTag> tags;
    while (true) {
      const auto open = std::min(text_.find('<', at_), text_.size());
      if (!tags.empty()) tags.back().text = text_.substr(at_, open - at_);
      if (open == text_.size()) return tags;
      at_ = open;
      if (text_.substr(at_).starts_with("<?")) {
        skip_past("?>");
      } else if (text_.substr(at_).starts_with("<!--")) {
        skip_past("-->");
      } else {
        tags.push_back(tag());
      }
    }
  }

 private:
  [[noreturn]] void fail() const {
    file_.fail("byte " + std::to_string(at_), "the XML header is damaged; write the file again");
  }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_space() { at_ = std::min(text_.find_first_not_of(kSpace, at_), text_.size()); }
  void skip_past(std::string_view end) {
    const auto found = text_.find(end, at_);
    if (found == std::string_view::npos) fail();
    at_ = found + end.size();
  }
  std::string word() {
    const auto end = std::min(text_.find_first_of(kEndOfName, at_), text_.size());
    if (end == at_) fail();
    std::string word(text_.substr(at_, end - at_));
    at_ = end;
    return word;
  }
  std::string value() {
    const char quote = peek();
    const auto end = quote == '"' || quote == '\'' ? text_.find(quote, at_ + 1) : std::string_view::npos;
    if (end == std::string_view::npos) fail();
    std::string value(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
    return value;
  }
  VtiTag tag() {
    VtiTag tag;
    tag.offset = at_++;
    if (peek() == '/') {
      tag.name = '/';
      ++at_;
    }
    tag.name += word();
    for (skip_space(); peek() != '>'; skip_space()) {
      if (peek() == '/') {
        ++at_;
        if (peek() != '>') fail();
        continue;
      }
      std::string name = word();
      skip_space();
      if (peek() != '=') fail();
      ++at_;
      skip_space();
      tag.attributes.emplace_back(std::move(name), value());
    }
    ++at_;
    return tag;
  }

  const FieldInput& file_;
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

const std::string* VtiTag::find(std::string_view attribute) const {
  for (const auto& [key, value] : attributes)
    if (key == attribute) return &value;
  return nullptr;
}

std::vector<VtiTag> read_vti_tags(const FieldInput& file, std::string_view header) {
  return Scanner(file, header).tags();
}

}  // namespace standoff
