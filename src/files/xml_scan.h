// SPDX-License-Identifier: Apache-2.0
// The tags of an XML text one after the other, without building its tree.
#pragma once

#include <cstddef>
#include <optional>
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
