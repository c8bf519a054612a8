// SPDX-License-Identifier: Apache-2.0
// NRRD: a text header, an empty line, samples, plain or packed by gzip. https://teem.sourceforge.net/nrrd/format.html
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "files/file_view.h"
#include "files/text.h"
#include "files/zip.h"
#include "io/field/format.h"
#include "io/field/read_samples.h"
#include "io/field/write_samples.h"

namespace standoff {
namespace {

struct NrrdLine {
  std::string text;
  int number = 0;
};

struct NrrdHeader {
  const FileView& file;
  std::map<std::string, NrrdLine> fields;  ///< "name: value", names in lower case and without blanks
  std::map<std::string, NrrdLine> keys;    ///< "key:=value", escapes undone
  std::uint64_t data = 0;                  ///< offset of the first sample

  /// Throws Error{input} that names the line.
  [[noreturn]] void fail(const NrrdLine& line, const std::string& what) const;
  /// The field of that name, which is the same with blanks and without ("axis mins"), or nullptr.
  const NrrdLine* find(const std::string& name) const;
  /// The field of that name, or an error.
  const NrrdLine& get(const std::string& name) const;
  /// The key of that name, or nullptr.
  const NrrdLine* key(const std::string& name) const;
};

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

bool is_gzip_encoding(const NrrdLine& encoding) { return encoding.text == "gzip" || encoding.text == "gz"; }

// What changes where or how samples are stored, and is not read.
void refuse_unsupported(const NrrdHeader& header) {
  const NrrdLine& type = header.get("type");
  if (type.text != "float")
    header.fail(type, "samples of type " + in_quotes(type.text) + " are not read; convert them to float");
  const NrrdLine& encoding = header.get("encoding");
  if (encoding.text != "raw" && !is_gzip_encoding(encoding))
    header.fail(encoding,
                "encoding " + in_quotes(encoding.text) + " is not read; save it raw (unu save -f nrrd -e raw)");
  if (const NrrdLine* line = header.find("data file"))
    header.fail(*line, "samples in another file are not read; save one .nrrd");
  for (const char* name : {"byte skip", "line skip"})
    if (const NrrdLine* line = header.find(name); line && line->text != "0")
      header.fail(*line, "skips before the samples are not read; save the file without");
  if (const NrrdLine& dimension = header.get("dimension"); dimension.text != "3")
    header.fail(dimension, "a field has 3 dimensions, not " + in_quotes(dimension.text) + "; save one of its volumes");
}

std::array<double, 3> numbers(const NrrdHeader& header, const NrrdLine& line, std::string_view text) {
  const auto words = words_of(text);
  std::array<double, 3> numbers{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto number = words.size() == 3 ? number_in<double>(words[n]) : std::nullopt;
    if (!number) header.fail(line, in_quotes(text) + " is not three numbers; write the file again");
    numbers[n] = *number;
  }
  return numbers;
}

// "(a,b,c)" up to three times, as spaces and numbers.
std::vector<std::array<double, 3>> vectors(const NrrdHeader& header, const NrrdLine& line) {
  std::vector<std::array<double, 3>> vectors;
  std::string_view rest = trimmed(line.text);
  while (!rest.empty()) {
    const auto close = rest.find(')');
    if (!rest.starts_with('(') || close == std::string_view::npos)
      header.fail(line, in_quotes(line.text) + " is not made of vectors (x,y,z); write the file again");
    std::string inside(rest.substr(1, close - 1));
    for (char& c : inside)
      if (c == ',') c = ' ';
    vectors.push_back(numbers(header, line, inside));
    rest = trimmed(rest.substr(close + 1));
  }
  return vectors;
}

void read_space(const NrrdHeader& header, Grid& grid) {
  if (const NrrdLine* line = header.find("space directions")) {
    const auto axes = vectors(header, *line);
    if (axes.size() != 3) header.fail(*line, "three directions are needed; write the file again");
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 3; ++column)
        if (row != column && axes[row][column] != 0)
          header.fail(*line, "the axes of the grid must be those of the world; resample it");
    grid.spacing = {axes[0][0], axes[1][1], axes[2][2]};
  } else if (const NrrdLine* spacings = header.find("spacings")) {
    const auto h = numbers(header, *spacings, spacings->text);
    grid.spacing = {h[0], h[1], h[2]};
  } else {
    header.file.fail("header", "neither 'space directions' nor 'spacings' is there; write the file again");
  }
  if (const NrrdLine* line = header.find("space origin")) {
    const auto origin = vectors(header, *line);
    if (origin.size() != 1) header.fail(*line, "one vector (x,y,z) is needed; write the file again");
    grid.origin = {origin[0][0], origin[0][1], origin[0][2]};
  } else if (const NrrdLine* mins = header.find("axis mins")) {
    const auto origin = numbers(header, *mins, mins->text);
    grid.origin = {origin[0], origin[1], origin[2]};
  }
}

Size3 read_sizes(const NrrdHeader& header) {
  const NrrdLine& line = header.get("sizes");
  const auto words = words_of(line.text);
  std::array<std::int64_t, 3> sizes{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto size = words.size() == 3 ? number_in<std::int64_t>(words[n]) : std::nullopt;
    if (!size) header.fail(line, in_quotes(line.text) + " is not three whole numbers; write the file again");
    sizes[n] = *size;
  }
  return {sizes[0], sizes[1], sizes[2]};
}

// Samples that are packed, after the empty line, by gzip.
StoredArray packed(const FileView& file, const NrrdHeader& header, const Grid& grid, const NrrdLine& endian) {
  require_valid(file, grid);
  const std::string_view bytes = file.text(header.data, file.size());
  if (sample_bytes(grid) / kMostDeflated > bytes.size())
    header.fail(header.get("sizes"),
                "they ask for more samples than so short a file can hold; it is cut off or damaged, get all of it");
  return {0, endian.text == "big", false, [&file, bytes] { return std::make_unique<GzipStream>(file, bytes); }, true};
}

void write_gzip(AtomicFile& file, const FieldSource& field, const SampleArray& array, int threads) {
  file.write("\x1f\x8b\x08\0\0\0\0\0\0\xff", 10);  // deflated, without a name, a time or a system
  std::uint32_t crc = 0;
  pack_samples(field, array, {}, {BlockKind::deflate, threads, 0}, [&](const PackedBlock& block) {
    file.write(block.bytes.data(), block.bytes.size());
    crc = block.crc;
  });
  file.write(kDeflateEnd.data(), kDeflateEnd.size());
  const auto bytes = static_cast<std::uint32_t>(sample_bytes(field.grid()));  // modulo 2^32
  file.write(&crc, sizeof crc);
  file.write(&bytes, sizeof bytes);
}

FieldFile read_nrrd(const FileView& file, const FieldRequest& request) {
  const NrrdHeader header = read_nrrd_header(file);
  refuse_unsupported(header);
  StoredField stored{.grid = {.size = read_sizes(header)}};
  read_space(header, stored.grid);
  const NrrdLine& endian = header.get("endian");
  if (endian.text != "little" && endian.text != "big")
    header.fail(endian, "endian is little or big; write the file again");
  stored.distance = {header.data, endian.text == "big", false, {}, false};
  if (is_gzip_encoding(header.get("encoding"))) stored.distance = packed(file, header, stored.grid, endian);
  if (const NrrdLine* line = header.key("thickness")) {
    const auto thickness = number_in<double>(trimmed(line->text));
    if (!thickness) header.fail(*line, "the thickness is not a number; write the file again");
    stored.thickness = *thickness;
  }
  if (const NrrdLine* line = header.key("method")) stored.provenance.method = line->text.substr(0, kMaxText);
  if (const NrrdLine* line = header.key("version")) stored.provenance.version = line->text.substr(0, kMaxText);
  if (const NrrdLine* line = header.key("sign")) stored.provenance.sign = line->text.substr(0, kMaxText);
  if (const NrrdLine* line = header.key("up")) stored.provenance.up = axis_in(line->text);
  if (const NrrdLine* line = header.key("mesh_hash")) stored.provenance.mesh_hash = hash_in(line->text).value_or(0);
  return load_field(file, stored, request);
}

void write_nrrd(AtomicFile& file, const FieldSource& field, const FieldWriteOptions& options) {
  const Grid& grid = field.grid();
  const auto text = [](double number) { return exact_text(number); };
  const auto vector = [&](double x, double y, double z) {
    return std::string("(") + text(x) + "," + text(y) + "," + text(z) + ")";
  };
  const Vec3 corner = grid.corner();
  const std::string& sign = field.provenance().sign;
  const std::string up = axis_text(field.provenance().up);
  const std::string header =
      "NRRD0005\n# Distances to a triangle mesh, at most the thickness, by standoff\n"
      "type: float\ndimension: 3\nspace dimension: 3\nsizes: " +
      std::to_string(grid.size.x) + " " + std::to_string(grid.size.y) + " " + std::to_string(grid.size.z) +
      "\nspace directions: " + vector(grid.spacing.x, 0, 0) + " " + vector(0, grid.spacing.y, 0) + " " +
      vector(0, 0, grid.spacing.z) + "\ncenters: node node node\nkinds: domain domain domain\nendian: little\n" +
      "encoding: " + (options.compress ? "gzip" : "raw") + "\nspace origin: " + vector(corner.x, corner.y, corner.z) +
      "\nthickness:=" + text(field.thickness()) + "\nmethod:=" + escaped(field.provenance().method) +
      "\nmesh_hash:=" + hash_text(field.provenance().mesh_hash) + "\nversion:=" + escaped(field.provenance().version) +
      (sign.empty() ? "" : "\nsign:=" + escaped(sign)) + (up.empty() ? "" : "\nup:=" + up) + "\n\n";
  file.write(header.data(), header.size());
  const SampleArray& distances = field.arrays()[0];
  if (options.compress)
    write_gzip(file, field, distances, options.threads);
  else
    send_samples(field, distances, {}, [&](std::span<const std::byte> part) { file.write(part.data(), part.size()); });
}

}  // namespace

constinit const FieldFormat kFieldNrrd{.extension = "nrrd",
                                       .description = "NRRD, for Slicer, ITK and teem",
                                       .slabs = true,
                                       .read = read_nrrd,
                                       .write = write_nrrd};

}  // namespace standoff
