// SPDX-License-Identifier: Apache-2.0
// NRRD: a text header, an empty line, raw samples.
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "files/file_view.h"
#include "files/zip.h"
#include "io/field/format.h"
#include "io/field/header_text.h"
#include "io/field/nrrd_header.h"
#include "io/field/samples.h"
#include "io/field/send_samples.h"

namespace standoff {
namespace {

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

}  // namespace

FieldFile read_nrrd(const FileView& file, const FieldRequest& request) {
  const NrrdHeader header = read_nrrd_header(file);
  refuse_unsupported(header);
  StoredField stored;
  stored.grid.size = read_sizes(header);
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
  if (const NrrdLine* line = header.key("mesh_hash")) stored.provenance.mesh_hash = hash_in(line->text).value_or(0);
  return load_field(file, stored, request);
}

void write_nrrd(AtomicFile& file, const FieldSource& field, const FieldWriteOptions& options) {
  const Grid& grid = field.grid();
  const auto text = [](double number) { return exact_text(number); };
  const auto vector = [&](double x, double y, double z) {
    return std::string("(") + text(x) + "," + text(y) + "," + text(z) + ")";
  };
  const std::string& sign = field.provenance().sign;
  const std::string header =
      "NRRD0005\n# Distances to a triangle mesh, at most the thickness, by standoff\n"
      "type: float\ndimension: 3\nspace dimension: 3\nsizes: " +
      std::to_string(grid.size.x) + " " + std::to_string(grid.size.y) + " " + std::to_string(grid.size.z) +
      "\nspace directions: " + vector(grid.spacing.x, 0, 0) + " " + vector(0, grid.spacing.y, 0) + " " +
      vector(0, 0, grid.spacing.z) + "\ncenters: node node node\nkinds: domain domain domain\nendian: little\n" +
      "encoding: " + (options.compress ? "gzip" : "raw") +
      "\nspace origin: " + vector(grid.origin.x, grid.origin.y, grid.origin.z) +
      "\nthickness:=" + text(field.thickness()) + "\nmethod:=" + nrrd_escaped(field.provenance().method) +
      "\nmesh_hash:=" + hash_text(field.provenance().mesh_hash) +
      "\nversion:=" + nrrd_escaped(field.provenance().version) + (sign.empty() ? "" : "\nsign:=" + nrrd_escaped(sign)) +
      "\n\n";
  file.write(header.data(), header.size());
  const SampleArray& distances = field.arrays()[0];
  if (options.compress)
    write_gzip(file, field, distances, options.threads);
  else
    send_samples(field, distances, {}, [&](std::span<const std::byte> part) { file.write(part.data(), part.size()); });
}

}  // namespace standoff
