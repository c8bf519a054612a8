// SPDX-License-Identifier: Apache-2.0
#include "io/field/nrrd_header.h"

#include <algorithm>
#include <array>

#include "files/file_view.h"
#include "io/field/header_text.h"

namespace standoff {
namespace {

constexpr std::uint64_t kMaxHeader = std::uint64_t{1} << 20;  // far more than any header needs

// The fields of the format, without blanks. Another one is a damaged name, and what it says would be lost: where the
// grid begins, say.
constexpr std::array<std::string_view, 28> kFields{
    "content",     "number",   "type",     "blocksize",       "dimension",   "space",      "spacedimension",
    "sizes",       "spacings", "axismins", "axismaxs",        "thicknesses", "centers",    "centerings",
    "labels",      "units",    "kinds",    "spacedirections", "spaceorigin", "spaceunits", "measurementframe",
    "sampleunits", "min",      "max",      "oldmin",          "oldmax",      "endian",     "encoding"};
constexpr std::array<std::string_view, 3> kPlaces{"datafile", "lineskip", "byteskip"};

std::string without_blanks(std::string name) {
  std::erase(name, ' ');
  return name;
}

// Values of keys may hold line breaks, spelt \n, and backslashes, spelt \\.
std::string unescaped(const std::string& text) {
  std::string value;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '\\' && i + 1 < text.size();
    if (escape) ++i;
    value += escape && text[i] == 'n' ? '\n' : text[i];
  }
  return value;
}

void take_line(NrrdHeader& header, const NrrdLine& line) {
  if (line.text.starts_with('#')) return;
  // A key may hold colons ("http://a:=b"), but none before a blank: that one ends a field's name.
  const auto equals = line.text.find(":=");
  const bool is_key = equals != std::string::npos && line.text.find(": ") > equals;
  const auto colon = is_key ? equals : line.text.find(':');
  if (colon == std::string::npos || colon + 1 == line.text.size())
    header.fail(line, in_quotes(line.text) + " is no header field; the file is damaged or no NRRD, write it again");
  std::string name = line.text.substr(0, colon);
  if (is_key) {
    header.keys[name] = {unescaped(line.text.substr(colon + 2)), line.number};
    return;
  }
  for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  name = without_blanks(name);
  if (std::ranges::find(kFields, name) == kFields.end() && std::ranges::find(kPlaces, name) == kPlaces.end())
    header.fail(line, in_quotes(line.text) +
                          " is no field of a NRRD header; the file is damaged, write it again (what is your own goes "
                          "into a key, 'name:=value')");
  header.fields[name] = {std::string(trimmed(std::string_view(line.text).substr(colon + 1))), line.number};
}

}  // namespace

void NrrdHeader::fail(const NrrdLine& line, const std::string& what) const {
  file.fail("line " + std::to_string(line.number), what);
}

const NrrdLine* NrrdHeader::find(const std::string& name) const {
  const auto found = fields.find(without_blanks(name));
  return found == fields.end() ? nullptr : &found->second;
}

const NrrdLine& NrrdHeader::get(const std::string& name) const {
  if (const NrrdLine* line = find(name)) return *line;
  file.fail("header", "the field '" + name + "' is missing; write the file again");
}

const NrrdLine* NrrdHeader::key(const std::string& name) const {
  const auto found = keys.find(name);
  return found == keys.end() ? nullptr : &found->second;
}

NrrdHeader read_nrrd_header(const FileView& file) {
  const std::string_view text = file.text(0, kMaxHeader);
  if (!text.starts_with("NRRD000")) file.fail("header", "it does not begin with NRRD000; give a NRRD file");
  NrrdHeader header{file, {}, {}, 0};
  std::size_t at = 0;
  for (int number = 1;; ++number) {
    const auto end = text.find('\n', at);
    if (end == std::string::npos)
      file.fail("header",
                "no empty line ends it; the file is truncated, or keeps its samples in another file: join them");
    std::string line(text.substr(at, end - at));
    if (line.ends_with('\r')) line.pop_back();
    at = end + 1;
    if (line.empty()) break;
    if (number > 1) take_line(header, {line, number});
  }
  header.data = at;
  return header;
}

std::string nrrd_escaped(const std::string& value) {
  std::string text;
  for (const char c : value) text += c == '\n' ? "\\n" : c == '\\' ? "\\\\" : std::string(1, c);
  return text;
}

}  // namespace standoff
