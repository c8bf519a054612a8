// The tags of an XML text one after the other, without building its tree.
#pragma once

#include <string>
#include <string_view>

#include "files/file_view.h"

namespace standoff {

struct XmlTag {
  enum class Kind { open, close, whole };  ///< <a>, </a>, <a/>
  Kind kind;
  std::string_view name;
  std::string_view attributes;  ///< as written
  std::string_view text;        ///< what follows, up to the next tag or comment
  bool only_text;               ///< what ends the text is a closing tag

  /// The value of an attribute as written, or nothing. The first one counts.
  std::string_view attribute(std::string_view name) const;
};

/// Reads UTF-8 without document types; comments, CDATA and instructions are passed over. Checks the form of tags only,
/// not that they match. Errors: input, with the line.
class XmlScan {
 public:
  explicit XmlScan(const FileView& file);

  /// False at the end.
  bool next(XmlTag& tag);
  /// Throws with the line of the tag read last, or after the end without one.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skip_past(std::string_view end);
  XmlTag read_tag();

  const FileView& file_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t tag_ = 0;
};

}  // namespace standoff
