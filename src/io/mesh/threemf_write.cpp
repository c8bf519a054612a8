// SPDX-License-Identifier: Apache-2.0
// Writes 3MF: a zip archive of the model, which is XML, and two parts that say where it is. One object, built once.
#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "files/checksums.h"
#include "files/deflate.h"
#include "files/zip.h"
#include "io/mesh/writers.h"

namespace standoff {
namespace {

constexpr std::string_view kContentTypes =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
)";
constexpr std::string_view kRelationships =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
)";

// Attributes of an element, one after the other.
class Attributes {
 public:
  explicit Attributes(std::string& text) : text_(text) {}
  template <class Number>
  Attributes& add(std::string_view before, Number number) {
    std::array<char, 32> digits;
    text_ += before;
    text_.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
    text_ += '"';
    return *this;
  }

 private:
  std::string& text_;
};

std::string model_xml(MeshView mesh, const MeshWriteOptions& options) {
  constexpr std::size_t kBytesOfVertex = 80, kBytesOfTriangle = 50;  // about
  std::string text;
  text.reserve(1000 + kBytesOfVertex * mesh.vertices.size() + kBytesOfTriangle * mesh.triangles.size());
  text += R"(<?xml version="1.0" encoding="UTF-8"?>
<model unit=")" +
          std::string(options.metres_per_unit > 0 ? "meter" : "millimeter") +
          R"(" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<metadata name="Application">standoff</metadata>
<resources><object id="1" type="model"><mesh>
<vertices>
)";
  for (const Vec3& vertex : mesh.vertices) {
    const Vec3 p = placed(vertex, options, Axis::z);
    Attributes(text).add("<vertex x=\"", p.x).add(" y=\"", p.y).add(" z=\"", p.z);
    text += "/>\n";
  }
  text += "</vertices>\n<triangles>\n";
  for (const Triangle& t : mesh.triangles) {
    Attributes(text).add("<triangle v1=\"", t[0]).add(" v2=\"", t[1]).add(" v3=\"", t[2]);
    text += "/>\n";
  }
  text += "</triangles>\n</mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>\n";
  return text;
}

void add_member(ZipWriter& zip, const std::string& name, std::string_view text) {
  constexpr int kLevel = 6;
  constexpr std::size_t kZlibHeader = 2, kZlibChecksum = 4;  // around what an archive holds
  const std::string packed = zlib_packed(text, kLevel);
  zip.begin_deflated(name, text.size());
  zip.write_deflated(std::string_view(packed).substr(kZlibHeader, packed.size() - kZlibHeader - kZlibChecksum));
  zip.end_deflated(crc32_of(0, std::as_bytes(std::span(text))));
}

}  // namespace

void write_3mf(AtomicFile& file, MeshView mesh, const MeshWriteOptions& options) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (mesh.vertices.size() > kMost || mesh.triangles.size() > kMost)
    fail_to_write(file, "3MF holds at most 2147483647 vertices and triangles; write .ply");
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n)
    if (const Triangle& t = mesh.triangles[n]; t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      fail_to_write(file,
                    "triangle " + std::to_string(n) +
                        " names a vertex twice, which 3MF does not allow; repair the mesh, or write .ply or .obj");
  if (!file.can_overwrite()) fail_to_write(file, "3MF cannot be written to a pipe; write .ply or .obj");
  ZipWriter zip(file);
  add_member(zip, "[Content_Types].xml", kContentTypes);
  add_member(zip, "_rels/.rels", kRelationships);
  add_member(zip, "3D/3dmodel.model", model_xml(mesh, options));
  zip.finish();
}

}  // namespace standoff
