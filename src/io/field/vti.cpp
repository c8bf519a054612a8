// SPDX-License-Identifier: Apache-2.0
// VTI: VTK's XML image data with raw appended arrays, in one piece. A plain array follows its length in bytes (4 or 8
// bytes, when read); a compressed one is a table of blocks, and zlib's streams: number of blocks, bytes of a block, of
// the last one if it is shorter, and of each when packed.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid_axis.h"
#include "core/number_text.h"
#include "files/deflate.h"
#include "files/file_view.h"
#include "files/text.h"
#include "files/zip.h"
#include "io/field/format.h"
#include "io/field/read_samples.h"
#include "io/field/write_samples.h"

namespace standoff {
namespace {

/// What the table says; all blocks lie in the file and can become what they are said to.
struct VtkBlocks {
  struct Block {
    std::uint64_t at = 0, packed = 0, bytes = 0;  ///< where it begins, its length there, and unpacked
  };
  std::vector<Block> blocks;
  std::uint64_t bytes = 0;  ///< of all blocks, unpacked
};

/// The bytes of an array. Memory is taken for what is asked for at once.
class VtkBlockStream : public ByteStream {
 public:
  /// From a byte on. All must outlive it.
  VtkBlockStream(const FileView& file, const VtkBlocks& blocks, std::uint64_t first = 0)
      : file_(file), blocks_(blocks) {
    while (block_ < blocks.blocks.size() && first >= blocks.blocks[block_].bytes)
      first -= blocks.blocks[block_++].bytes;
    constexpr std::uint64_t kPart = std::uint64_t{1} << 20;
    for (; first > 0; first -= std::min(first, kPart)) next(std::min(first, kPart));
  }

  std::string_view next(std::uint64_t bytes) override;
  void finish() override {}

 private:
  const FileView& file_;
  const VtkBlocks& blocks_;
  std::size_t block_ = 0;       // that is being read
  std::uint64_t in_block_ = 0;  // bytes read of it
  std::optional<Inflater> inflater_;
  UnpackedBytes buffer_;
};

// A number of the appended data: of 4 bytes or 8, as the header says.
std::uint64_t vtk_number(const FileView& file, std::uint64_t at, unsigned bytes, bool big_endian) {
  if (bytes == 8) {
    const auto wide = file.number<std::uint64_t>(at);
    return big_endian ? __builtin_bswap64(wide) : wide;
  }
  const auto narrow = file.number<std::uint32_t>(at);
  return big_endian ? __builtin_bswap32(narrow) : narrow;
}

VtkBlocks read_vtk_blocks(const FileView& file, std::uint64_t at, unsigned number_bytes, bool big_endian) {
  const std::string where = "byte " + std::to_string(at);
  const auto number = [&](std::uint64_t n) {
    return vtk_number(file, at + n * number_bytes, number_bytes, big_endian);
  };
  const std::uint64_t count = number(0);
  if (count == 0) return {};
  const std::uint64_t full = number(1), last = number(2);
  constexpr std::uint64_t kFixed = 3;
  if (count > file.size() / number_bytes) file.fail(where, "a table of more blocks than fit; write the file again");
  file.require(at, (kFixed + count) * number_bytes, "a table of blocks");
  if (full == 0 || last > full) file.fail(where, "a table of blocks without a size; write the file again");
  VtkBlocks found;
  std::uint64_t place = at + (kFixed + count) * number_bytes;
  for (std::uint64_t n = 0; n < count; ++n) {
    const std::uint64_t packed = number(kFixed + n), bytes = n + 1 == count && last > 0 ? last : full;
    file.require(place, packed, "a block");
    if (bytes / kMostDeflated > packed)
      file.fail("byte " + std::to_string(place),
                "a block so short cannot hold what is said of it; write the file again");
    found.blocks.push_back({place, packed, bytes});
    found.bytes += bytes;
    place += packed;
  }
  return found;
}

std::string_view VtkBlockStream::next(std::uint64_t bytes) {
  char* const to = buffer_.room(bytes);
  for (std::uint64_t done = 0; done < bytes;) {
    const VtkBlocks::Block& block = blocks_.blocks.at(block_);
    if (!inflater_)
      inflater_.emplace(file_, "byte " + std::to_string(block.at), file_.text(block.at, block.packed),
                        Inflater::Wrapper::zlib);
    const std::uint64_t part = std::min(bytes - done, block.bytes - in_block_);
    inflater_->fill(to + done, part);
    done += part;
    in_block_ += part;
    if (in_block_ < block.bytes) continue;
    // The checksum is behind the last byte; what follows is not part of the array.
    char more;
    if (inflater_->read(&more, 1) != 0)
      file_.fail("byte " + std::to_string(block.at), "a block unpacks to more than is said; write the file again");
    inflater_.reset();
    in_block_ = 0;
    ++block_;
  }
  return {to, bytes};
}

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
    // VTK's origin is where index 0 lies, whether or not the extent begins there. An extent that begins at a sample of
    // the grid is a window of it.
    grid.origin = {origin[0], origin[1], origin[2]};
    const Size3 first{extent_[0], extent_[2], extent_[4]};
    if (first.x >= 0 && first.y >= 0 && first.z >= 0)
      grid.first = first;
    else
      grid.origin = grid.origin + grid.spacing * Vec3{double(first.x), double(first.y), double(first.z)};
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
      VtkBlocks blocks = read_vtk_blocks(file_, at, length_bytes_, big_endian_);
      const std::uint64_t bytes = blocks.bytes;
      return {0, std::move(blocks), bytes};
    }
    const std::uint64_t bytes = vtk_number(file_, at, length_bytes_, big_endian_);
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
    if (name == "up") stored_.provenance.up = axis_in(string_of(tag));
    if (name == "mesh_hash") stored_.provenance.mesh_hash = hash_in(string_of(tag)).value_or(0);
  }

  StoredArray stored(Payload found) const {
    if (!compressed_) return {.offset = found.at, .big_endian = big_endian_, .open = {}};
    auto blocks = std::make_shared<VtkBlocks>(std::move(found.blocks));
    return {.big_endian = big_endian_,
            .open = [file = &file_, blocks] { return std::make_unique<VtkBlockStream>(*file, *blocks); },
            .packed = true,
            .open_at = [file = &file_, blocks](
                           std::uint64_t first) { return std::make_unique<VtkBlockStream>(*file, *blocks, first); }};
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
  std::uint64_t data_ = 0;
  unsigned length_bytes_ = 4;
  XmlScan scan_;
  StoredField stored_;
  std::vector<XmlTag> points_;
  std::array<std::int64_t, 6> extent_{};
  int pieces_ = 0;
  bool found_file_ = false, found_image_ = false, big_endian_ = false, compressed_ = false;
};

FieldFile read_vti(const FileView& file, const FieldRequest& request) {
  const StoredField stored = VtiReader(file, request.sidecars).read();
  return load_field(file, stored, request);
}

StoredField vti_header(const FileView& file) { return VtiReader(file, true).read(); }

constexpr std::string_view kEnd = "\n  </AppendedData>\n</VTKFile>\n";

std::string three(double x, double y, double z) { return exact_text(x) + " " + exact_text(y) + " " + exact_text(z); }

// A small array of the field's facts.
struct Fact {
  const char* type;
  const char* name;
  std::string bytes;
};

std::vector<Fact> facts_of(const FieldSource& field) {
  const double thickness = field.thickness();
  const Provenance& from = field.provenance();
  std::vector<Fact> facts{{"Float64", "thickness", {reinterpret_cast<const char*>(&thickness), sizeof thickness}}};
  // Strings end with a zero byte, so they may hold none.
  const auto text = [&](const char* name, const std::string& value) {
    facts.push_back({"String", name, std::string(value.c_str()) + '\0'});
  };
  text("method", from.method);
  text("mesh_hash", hash_text(from.mesh_hash));
  text("version", from.version);
  if (!std::string(from.sign.c_str()).empty()) text("sign", from.sign);
  if (from.up) text("up", axis_text(from.up));
  return facts;
}

const char* name_of(NumberType type) {
  return type == NumberType::uint8 ? "UInt8" : type == NumberType::uint32 ? "UInt32" : "Float32";
}

class VtiWriter {
 public:
  VtiWriter(AtomicFile& file, const FieldSource& field, const FieldWriteOptions& options)
      : file_(file),
        field_(field),
        threads_(options.threads),
        compress_(options.compress && file.can_overwrite()),
        facts_(facts_of(field)),
        arrays_(field.arrays()) {}

  void write() {
    // Where arrays begin is known once those before them are packed; where they are not, beforehand.
    plan_offsets();
    const std::string planned = header();
    file_.write(planned.data(), planned.size());
    data_ = file_.size();
    offsets_.clear();
    for (const Fact& fact : facts_) write_fact(fact);
    for (const SampleArray& array : arrays_) write_array(array);
    file_.write(kEnd.data(), kEnd.size());
    if (!compress_) return;
    const std::string known = header();
    file_.overwrite(0, known.data(), known.size());
  }

 private:
  std::uint64_t bytes_of_array(const SampleArray& array) const {
    return static_cast<std::uint64_t>(field_.grid().sample_count()) * array.element_bytes();
  }

  void plan_offsets() {
    std::uint64_t offset = 0;
    const auto place = [&](std::uint64_t bytes) {
      offsets_.push_back(offset);
      offset += sizeof bytes + bytes;
    };
    for (const Fact& fact : facts_) place(fact.bytes.size());
    for (const SampleArray& array : arrays_) place(bytes_of_array(array));
  }

  // Offsets that are not known yet have room for all digits.
  std::string place(std::size_t n) const {
    std::string text = " format=\"appended\" offset=\"" + std::to_string(offsets_[n]) + "\"";
    if (compress_) text.append(20 - std::to_string(offsets_[n]).size(), ' ');
    return text + "/>\n";
  }

  std::string header() const {
    const Grid& g = field_.grid();
    // A window keeps its place in the whole grid: VTK's origin is that of the whole.
    const auto along = [](const GridAxis& axis) {
      return std::to_string(axis.first) + " " + std::to_string(axis.first + axis.size - 1);
    };
    const std::string extent = along(axis_of(g, 0)) + " " + along(axis_of(g, 1)) + " " + along(axis_of(g, 2));
    std::string text =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"";
    if (compress_) text += " compressor=\"vtkZLibDataCompressor\"";
    text += ">\n  <ImageData WholeExtent=\"" + extent + "\" Origin=\"" + three(g.origin.x, g.origin.y, g.origin.z) +
            "\" Spacing=\"" + three(g.spacing.x, g.spacing.y, g.spacing.z) +
            "\" Direction=\"1 0 0 0 1 0 0 0 1\">\n    <FieldData>\n";
    std::size_t n = 0;
    for (const Fact& fact : facts_) {
      const std::string element = fact.type == std::string("String") ? "Array" : "DataArray";
      text += "      <" + element + " type=\"" + fact.type + "\" Name=\"" + fact.name + "\" NumberOfTuples=\"1\"" +
              place(n++);
    }
    text += "    </FieldData>\n    <Piece Extent=\"" + extent + "\">\n      <PointData Scalars=\"distance\">\n";
    for (const SampleArray& array : arrays_) {
      text += std::string("        <DataArray type=\"") + name_of(array.type) + "\" Name=\"" + array.name + "\"";
      if (array.components > 1) text += " NumberOfComponents=\"" + std::to_string(array.components) + "\"";
      text += place(n++);
    }
    return text +
           "      </PointData>\n      <CellData/>\n    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n_";
  }

  void begin_array() { offsets_.push_back(file_.size() - data_); }
  void write_number(std::uint64_t number) { file_.write(&number, sizeof number); }

  void write_fact(const Fact& fact) {
    begin_array();
    if (!compress_) {
      write_number(fact.bytes.size());
      return file_.write(fact.bytes.data(), fact.bytes.size());
    }
    const std::string packed = zlib_stream(fact.bytes);
    for (const std::uint64_t number :
         {std::uint64_t{1}, std::uint64_t{fact.bytes.size()}, std::uint64_t{0}, std::uint64_t{packed.size()}})
      write_number(number);
    file_.write(packed.data(), packed.size());
  }

  void write_array(const SampleArray& array) {
    begin_array();
    if (!compress_) {
      write_number(bytes_of_array(array));
      return send_samples(field_, array, {},
                          [&](std::span<const std::byte> part) { file_.write(part.data(), part.size()); });
    }
    const auto step = static_cast<std::uint64_t>(block_elements(array, {}));
    const auto all = static_cast<std::uint64_t>(field_.grid().sample_count());
    constexpr std::size_t kFixed = 3;
    const std::uint64_t blocks = (all + step - 1) / step;
    std::vector<std::uint64_t> table(kFixed + blocks);
    table[0] = blocks;
    table[1] = step * array.element_bytes();
    table[2] = all % step * array.element_bytes();
    const std::uint64_t at = file_.size();
    file_.write(table.data(), table.size() * sizeof table[0]);
    std::size_t n = kFixed;
    pack_samples(field_, array, {}, {BlockKind::zlib, threads_, 0}, [&](const PackedBlock& block) {
      file_.write(block.bytes.data(), block.bytes.size());
      table[n++] = block.bytes.size();
    });
    file_.overwrite(at, table.data(), table.size() * sizeof table[0]);
  }

  AtomicFile& file_;
  const FieldSource& field_;
  int threads_;
  bool compress_;
  std::vector<Fact> facts_;
  const std::vector<SampleArray>& arrays_;
  std::vector<std::uint64_t> offsets_;  // of arrays, from the first byte of the appended data
  std::uint64_t data_ = 0;
};

void write_vti(AtomicFile& file, const FieldSource& field, const FieldWriteOptions& options) {
  VtiWriter(file, field, options).write();
}

}  // namespace

constinit const FieldFormat kFieldVti{.extension = "vti",
                                      .description = "VTK XML image data, for ParaView and VTK",
                                      .nearest = true,
                                      .sidecars = true,
                                      .slabs = true,
                                      .read = read_vti,
                                      .header = vti_header,
                                      .write = write_vti};

}  // namespace standoff
