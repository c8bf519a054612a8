// SPDX-License-Identifier: Apache-2.0
// VTI: what standoff and VTK write as raw appended data, plain or compressed by zlib, in one piece.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "files/file_view.h"
#include "files/text.h"
#include "io/field/format.h"
#include "io/field/header_text.h"
#include "io/field/samples.h"
#include "io/field/vtk_blocks.h"

namespace standoff {
namespace {

constexpr std::uint64_t kMostOfHeader = std::uint64_t{1} << 20;  // far more than any header needs
constexpr std::string_view kAppended = "<AppendedData";

class VtiReader {
 public:
  VtiReader(const FileView& file, bool sidecars)
      : file_(file), sidecars_(sidecars), head_(file.text(0, kMostOfHeader)), scan_(file, header()) {}

  StoredField read() {
    std::string_view section;
    XmlTag tag{}, last{};
    for (; scan_.next(tag); last = tag) {
      if (!tag.opens()) continue;
      if (tag.name == "VTKFile") read_file(tag);
      if (tag.name == "ImageData") read_image(tag);
      if (tag.name == "Piece") read_piece(tag);
      if (tag.name == "FieldData" || tag.name == "PointData" || tag.name == "CellData") section = tag.name;
      if (tag.name != "DataArray" && tag.name != "Array") continue;
      if (section == "PointData") points_.push_back(tag);
      if (section == "FieldData") read_fact(tag);
    }
    check_appended(last);
    if (!found_file_) file_.fail("header", "it is no VTK XML file; give a .vti file");
    if (!found_image_) file_.fail("header", "it holds no ImageData; save the field as image data");
    if (pieces_ != 1) file_.fail("header", "it has " + std::to_string(pieces_) + " pieces; save it as one");
    read_samples();
    return stored_;
  }

 private:
  [[noreturn]] void fail(const XmlTag& tag, const std::string& what) const { scan_.fail_at(tag, what); }
  std::string_view get(const XmlTag& tag, const char* attribute) const {
    if (const auto value = tag.find(attribute)) return *value;
    fail(tag, "<" + shown(tag.name) + "> lacks " + attribute + "; write the file again");
  }
  template <std::size_t n, class Number>
  std::array<Number, n> numbers(const XmlTag& tag, const char* attribute) const {
    const auto words = words_of(get(tag, attribute));
    std::array<Number, n> numbers{};
    for (std::size_t k = 0; k < n; ++k) {
      const auto number = words.size() == n ? number_in<Number>(words[k]) : std::nullopt;
      if (!number)
        fail(tag, std::string(attribute) + " is not " + std::to_string(n) + " numbers; write the file again");
      numbers[k] = *number;
    }
    return numbers;
  }

  // The text up to the tag that begins the appended data; what follows it is no XML.
  std::string_view header() {
    const auto start = head_.find(kAppended);
    if (start == std::string::npos)
      file_.fail("header", "no appended data; save it with raw appended data (no file of VTK? check its name)");
    const auto close = head_.find('>', start);
    const auto mark = close == std::string::npos ? close : head_.find('_', close);
    if (mark == std::string::npos || !trimmed(head_.substr(close + 1, mark - close - 1)).empty())
      file_.fail("byte " + std::to_string(start),
                 "no '_' begins the appended data; the file is damaged, write it again");
    data_ = mark + 1;
    return head_.substr(0, close + 1);
  }

  // The tag may stand in a comment or in an instruction, and other tags begin with its letters.
  void check_appended(const XmlTag& last) const {
    if (last.name != kAppended.substr(1)) scan_.fail("no tag begins the appended data; write the file again");
    if (last.attribute("encoding") != "raw") fail(last, "the appended data is not raw; save it with encoding raw");
  }

  void read_file(const XmlTag& tag) {
    found_file_ = true;
    if (get(tag, "type") != "ImageData")
      fail(tag, "it holds " + shown(get(tag, "type")) + "; save the field as ImageData");
    if (const auto compressor = tag.find("compressor")) {
      if (*compressor != "vtkZLibDataCompressor")
        fail(tag, "it is compressed by " + shown(*compressor) + ", which is not read; save it with zlib, or plain");
      compressed_ = true;
    }
    big_endian_ = get(tag, "byte_order") == "BigEndian";
    length_bytes_ = tag.attribute("header_type") == "UInt64" ? 8 : 4;
  }

  void read_image(const XmlTag& tag) {
    found_image_ = true;
    extent_ = numbers<6, std::int64_t>(tag, "WholeExtent");
    constexpr std::int64_t kFar = std::int64_t{1} << 40;
    for (const auto end : extent_)
      if (end < -kFar || end > kFar) fail(tag, "WholeExtent is too large; write the file again");
    Grid& grid = stored_.grid;
    grid.size = {extent_[1] - extent_[0] + 1, extent_[3] - extent_[2] + 1, extent_[5] - extent_[4] + 1};
    const auto origin = numbers<3, double>(tag, "Origin");
    const auto spacing = numbers<3, double>(tag, "Spacing");
    grid.spacing = {spacing[0], spacing[1], spacing[2]};
    // VTK's origin is where index 0 lies, whether or not the extent begins there.
    grid.origin = Vec3{origin[0], origin[1], origin[2]} +
                  grid.spacing * Vec3{double(extent_[0]), double(extent_[2]), double(extent_[4])};
    if (!tag.find("Direction")) return;
    const auto direction = numbers<9, double>(tag, "Direction");
    if (direction != std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1})
      fail(tag, "the axes of the grid must be those of the world; resample it");
  }

  void read_piece(const XmlTag& tag) {
    ++pieces_;
    if (found_image_ && numbers<6, std::int64_t>(tag, "Extent") != extent_)
      fail(tag, "the piece is not all of the image; save the whole as one piece");
  }

  // A number of the appended data: lengths have 4 bytes or 8.
  std::uint64_t length_at(std::uint64_t at) const {
    if (length_bytes_ == 8) {
      const auto wide = file_.number<std::uint64_t>(at);
      return big_endian_ ? __builtin_bswap64(wide) : wide;
    }
    const auto narrow = file_.number<std::uint32_t>(at);
    return big_endian_ ? __builtin_bswap32(narrow) : narrow;
  }

  // The bytes of an array.
  struct Payload {
    std::uint64_t at = 0;     // plain
    VtkBlocks blocks;         // compressed
    std::uint64_t bytes = 0;  // unpacked
  };
  Payload payload(const XmlTag& tag) const {
    if (get(tag, "format") != "appended")
      fail(tag, "the array is not in the appended data; save it with appended data");
    const auto offset = number_in<std::uint64_t>(get(tag, "offset"));
    if (!offset || *offset > file_.size()) fail(tag, "the array's offset lies outside the file; write the file again");
    const std::uint64_t at = data_ + *offset;
    if (compressed_) {
      VtkBlocks blocks = read_vtk_blocks(file_, at, static_cast<unsigned>(length_bytes_), big_endian_);
      const std::uint64_t bytes = blocks.bytes;
      return {0, std::move(blocks), bytes};
    }
    const std::uint64_t bytes = length_at(at);
    file_.require(at + length_bytes_, bytes, "an array");
    return {at + length_bytes_, {}, bytes};
  }

  // The bytes of a small array, appended or as numbers in the text.
  std::string bytes_of(const XmlTag& tag) const {
    if (get(tag, "format") == "appended") {
      const Payload found = payload(tag);
      const std::uint64_t bytes = std::min(found.bytes, kMaxText);
      if (!compressed_) return std::string(file_.text(found.at, bytes));
      return std::string(VtkBlockStream(file_, found.blocks).next(bytes));
    }
    if (get(tag, "format") != "ascii") fail(tag, "facts are read from appended or ascii arrays; save them as such");
    std::string bytes;
    for (const auto word : words_of(tag.text)) bytes += static_cast<char>(number_in<std::uint8_t>(word).value_or('?'));
    bytes.resize(std::min<std::size_t>(bytes.size(), kMaxText));
    return bytes;
  }
  std::string string_of(const XmlTag& tag) const { return bytes_of(tag).c_str(); }

  void read_thickness(const XmlTag& tag) {
    if (get(tag, "type") != "Float64") fail(tag, "the thickness is not of type Float64; write the file again");
    if (get(tag, "format") == "ascii") {
      const auto words = words_of(tag.text);
      const auto number = words.size() == 1 ? number_in<double>(words[0]) : std::nullopt;
      if (!number) fail(tag, "the thickness is not a number; write the file again");
      stored_.thickness = *number;
      return;
    }
    const std::string bytes = bytes_of(tag);
    if (bytes.size() != sizeof(double)) fail(tag, "the thickness is not one number; write the file again");
    std::uint64_t bits = 0;
    std::memcpy(&bits, bytes.data(), sizeof bits);
    stored_.thickness = std::bit_cast<double>(big_endian_ ? __builtin_bswap64(bits) : bits);
  }

  void read_fact(const XmlTag& tag) {
    const std::string_view name = tag.attribute("Name");
    if (name == "thickness") read_thickness(tag);
    if (name == "method") stored_.provenance.method = string_of(tag);
    if (name == "version") stored_.provenance.version = string_of(tag);
    if (name == "sign") stored_.provenance.sign = string_of(tag);
    if (name == "mesh_hash") stored_.provenance.mesh_hash = hash_in(string_of(tag)).value_or(0);
  }

  StoredArray stored(Payload found) const {
    if (!compressed_) return {.offset = found.at, .big_endian = big_endian_, .open = {}};
    auto blocks = std::make_shared<VtkBlocks>(std::move(found.blocks));
    return {.big_endian = big_endian_,
            .open = [file = &file_, blocks] { return std::make_unique<VtkBlockStream>(*file, *blocks); },
            .packed = true};
  }

  StoredArray samples(const XmlTag& tag, const char* type) const {
    if (get(tag, "type") != type)
      fail(tag, "samples of type " + shown(get(tag, "type")) + " are not read; save them as " + type);
    if (const auto n = tag.find("NumberOfComponents"); n && *n != "1")
      fail(tag, "it has " + shown(*n) + " numbers per sample; save one");
    Payload found = payload(tag);
    if (found.bytes != sample_bytes(stored_.grid))
      fail(tag, "it has " + std::to_string(found.bytes) +
                    " bytes, not 4 for each sample of WholeExtent; write the file again");
    return stored(std::move(found));
  }

  // Other arrays with a number or a few for each sample.
  void read_sidecar(const XmlTag& tag) {
    const auto type = tag.attribute("type");
    const std::string name(tag.attribute("Name"));
    const auto known = [&](const StoredSidecar& one) { return one.name == name; };
    if ((type != "Float32" && type != "UInt8") || name.empty() || std::ranges::any_of(stored_.sidecars, known)) return;
    const auto components = tag.find("NumberOfComponents") ? number_in<int>(tag.attribute("NumberOfComponents")) : 1;
    constexpr int kMostComponents = 64;
    if (!components || *components < 1 || *components > kMostComponents) return;
    Payload found = payload(tag);
    const std::uint64_t samples = sample_bytes(stored_.grid) / 4;
    if (found.bytes != samples * (type == "UInt8" ? 1 : 4) * static_cast<std::uint64_t>(*components)) return;
    StoredArray array = stored(std::move(found));
    array.type = type == "UInt8" ? NumberType::uint8 : NumberType::float32;
    array.components = *components;
    stored_.sidecars.push_back({name, std::move(array)});
  }

  void read_samples() {
    require_valid(file_, stored_.grid);
    const XmlTag* distance = nullptr;
    for (const XmlTag& tag : points_) {
      const std::string_view name = tag.attribute("Name");
      if (name == "nearest_triangle") stored_.nearest = samples(tag, "UInt32");
      if (name == "distance") distance = &tag;
    }
    // A file of another program, whose only array must be the distance.
    if (!distance && points_.size() == 1) distance = points_.data();
    if (!distance) file_.fail("header", "its point data lacks an array 'distance'; name it so");
    stored_.distance = samples(*distance, "Float32");
    if (sidecars_)
      for (const XmlTag& tag : points_)
        if (&tag != distance && tag.attribute("Name") != "nearest_triangle") read_sidecar(tag);
  }

  const FileView& file_;
  bool sidecars_;
  std::string_view head_;
  std::uint64_t data_ = 0, length_bytes_ = 4;
  XmlScan scan_;
  StoredField stored_;
  std::vector<XmlTag> points_;
  std::array<std::int64_t, 6> extent_{};
  int pieces_ = 0;
  bool found_file_ = false, found_image_ = false, big_endian_ = false, compressed_ = false;
};

}  // namespace

FieldFile read_vti(const FileView& file, const FieldRequest& request) {
  const StoredField stored = VtiReader(file, request.sidecars).read();
  return load_field(file, stored, request);
}

}  // namespace standoff
