// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/xml.h"

#include "tests/grammar/hostile.h"

namespace standoff::grammar {
namespace {

std::string repeated(std::uint32_t times, const std::string& text) {
  std::string all;
  for (; times > 0; --times) all += text;
  return all;
}

// What may stand between tags of a bad file, and partly of a good one.
std::string intrusion(Choices& c) {
  constexpr const char* kThings[] = {"<!DOCTYPE x [<!ENTITY a \"&b;&b;\"><!ENTITY b \"&a;\">]>&a;",
                                     "<!DOCTYPE x SYSTEM \"file:///dev/zero\">",
                                     "<![CDATA[ ]]>",
                                     "<?php 1 ?>",
                                     "<!-- <p>1</p> --",
                                     "&#0;",
                                     "&#xffffffff;",
                                     "&lt;&unknown;",
                                     "</x>",
                                     "<x",
                                     "<",
                                     ">",
                                     "<>",
                                     "</>",
                                     "<x a=b>",
                                     "<x a='1' a='2'/>",
                                     "\xff\xfe<",
                                     "<?xml version=\"1.0\" encoding=\"UTF-16\"?>"};
  switch (c.below(4)) {
    case 0: {
      const std::uint32_t deep = c.many();
      return repeated(deep, "<node>") + (c.one_in(2) ? "" : repeated(deep, "</node>"));
    }
    case 1:
      return repeated(c.many(), c.one_in(2) ? "<a/>" : "<!---->");
    default:
      return c.pick(kThings);
  }
}

}  // namespace

std::string Xml::text(Choices& c, bool comments) const {
  std::string to;
  if (c.trick()) to += intrusion(c);
  if (!c.one_in(4)) to += "<?xml version=\"1.0\"" + std::string(c.one_in(2) ? " encoding=\"utf-8\"" : "") + "?>\n";
  if (c.one_in(4)) to += "<!-- written by a grammar -->";
  write(c, comments, to);
  return to + (c.one_in(2) ? "\n" : "");
}

void Xml::write_attributes(Choices& c, std::string& to) const {
  for (const auto& [name, value] : attributes_) {
    if (c.trick()) continue;
    for (int times = c.trick() ? 2 : 1; times > 0; --times) {
      const char quote = c.one_in(4) ? '\'' : '"';
      to += (c.one_in(6) ? "\n " : " ") + word(c, name) + (c.one_in(8) ? " = " : "=") + quote + word(c, value) + quote;
    }
  }
  if (c.trick()) to += " many='" + std::string(c.many(), '<') + "'";
  if (c.one_in(8)) to += " ";
}

void Xml::write(Choices& c, bool comments, std::string& to) const {
  to += c.one_in(4) ? "\n" : "";
  if (comments && c.one_in(12)) to += "<!-- <p>1</p> -->";
  if (c.trick()) to += intrusion(c);
  const std::string name = word(c, name_);
  to += "<" + name;
  write_attributes(c, to);
  if (text_.empty() && children_.empty() && c.below(4) > 0) {
    to += "/>";
    return;
  }
  to += ">" + text_;
  for (const Xml& child : children_) {
    if (c.trick()) continue;
    for (int times = c.trick() ? 2 : 1; times > 0; --times) child.write(c, comments, to);
  }
  if (!c.trick()) to += "</" + name + ">";
}

}  // namespace standoff::grammar
