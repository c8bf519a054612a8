// SPDX-License-Identifier: Apache-2.0
// VTI: VTK's XML image data with raw appended arrays, each after its length in bytes (64 bits).
#include <cstdint>
#include <string>

#include "core/number_text.h"
#include "io/field/format.h"
#include "io/field/samples.h"

namespace standoff {
namespace {

// Writes the elements of arrays and counts where their bytes will lie.
class Elements {
 public:
  std::string array(const std::string& indent, const char* type, const char* name, std::uint64_t bytes,
                    const char* more = "") {
    const std::string element = std::string(type) == "String" ? "Array" : "DataArray";
    const std::string text = indent + "<" + element + " type=\"" + type + "\" Name=\"" + name + "\"" + more +
                             " format=\"appended\" offset=\"" + std::to_string(offset_) + "\"/>\n";
    offset_ += sizeof(std::uint64_t) + bytes;
    return text;
  }

 private:
  std::uint64_t offset_ = 0;
};

std::string three(double x, double y, double z) { return exact_text(x) + " " + exact_text(y) + " " + exact_text(z); }

std::string header_of(const DistanceField& field, const std::string& method, const std::string& hash,
                      const std::string& version, const std::string& sign) {
  const Grid& g = field.grid();
  const auto last = [](std::int64_t side) { return std::to_string(side - 1); };
  const std::string extent = "0 " + last(g.size.x) + " 0 " + last(g.size.y) + " 0 " + last(g.size.z);
  constexpr const char* kOne = " NumberOfTuples=\"1\"";
  Elements elements;
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <ImageData WholeExtent=\"" +
      extent + "\" Origin=\"" + three(g.origin.x, g.origin.y, g.origin.z) + "\" Spacing=\"" +
      three(g.spacing.x, g.spacing.y, g.spacing.z) +
      "\" Direction=\"1 0 0 0 1 0 0 0 1\">\n"
      "    <FieldData>\n";
  text += elements.array("      ", "Float64", "thickness", sizeof(double), kOne);
  text += elements.array("      ", "String", "method", method.size() + 1, kOne);
  text += elements.array("      ", "String", "mesh_hash", hash.size() + 1, kOne);
  text += elements.array("      ", "String", "version", version.size() + 1, kOne);
  if (!sign.empty()) text += elements.array("      ", "String", "sign", sign.size() + 1, kOne);
  text += "    </FieldData>\n    <Piece Extent=\"" + extent + "\">\n      <PointData Scalars=\"distance\">\n";
  text += elements.array("        ", "Float32", "distance", sample_bytes(g));
  if (field.has_nearest()) text += elements.array("        ", "UInt32", "nearest_triangle", sample_bytes(g));
  return text +
         "      </PointData>\n      <CellData/>\n    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n_";
}

}  // namespace

void write_vti(AtomicFile& file, const DistanceField& field) {
  // Strings end with a zero byte, so they may hold none.
  const std::string method = field.provenance().method.c_str(), version = field.provenance().version.c_str(),
                    sign = field.provenance().sign.c_str();
  const std::string hash = hash_text(field.provenance().mesh_hash);
  const auto sink = [&](std::span<const std::byte> part) { file.write(part.data(), part.size()); };
  const auto block = [&](const void* data, std::uint64_t bytes) {
    file.write(&bytes, sizeof bytes);
    file.write(data, bytes);
  };
  const std::string header = header_of(field, method, hash, version, sign);
  file.write(header.data(), header.size());
  const double thickness = field.thickness();
  block(&thickness, sizeof thickness);
  for (const std::string* text : {&method, &hash, &version}) block(text->c_str(), text->size() + 1);
  if (!sign.empty()) block(sign.c_str(), sign.size() + 1);
  const std::uint64_t bytes = sample_bytes(field.grid());
  file.write(&bytes, sizeof bytes);
  send_values(field, sink);
  if (field.has_nearest()) {
    file.write(&bytes, sizeof bytes);
    send_nearest(field, sink);
  }
  constexpr std::string_view kEnd = "\n  </AppendedData>\n</VTKFile>\n";
  file.write(kEnd.data(), kEnd.size());
}

}  // namespace standoff
