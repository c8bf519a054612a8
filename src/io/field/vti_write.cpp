// SPDX-License-Identifier: Apache-2.0
// VTI: VTK's XML image data with raw appended arrays. A plain array follows its length in bytes (64 bits); a compressed
// one is a table of blocks, and zlib's streams: number of blocks, bytes of a block, of the last one if it is shorter,
// and of each when packed.
#include <cstdint>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "files/deflate.h"
#include "io/field/format.h"
#include "io/field/send_samples.h"

namespace standoff {
namespace {

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
    const auto last = [](std::int64_t side) { return std::to_string(side - 1); };
    const std::string extent = "0 " + last(g.size.x) + " 0 " + last(g.size.y) + " 0 " + last(g.size.z);
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

}  // namespace

void write_vti(AtomicFile& file, const FieldSource& field, const FieldWriteOptions& options) {
  VtiWriter(file, field, options).write();
}

}  // namespace standoff
