// SPDX-License-Identifier: Apache-2.0
// PLY: any properties in any order; only positions and faces are kept.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "files/file_view.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"
#include "io/mesh/ply_data.h"

namespace standoff {
namespace {

template <class Body>
class PlyReader {
 public:
  PlyReader(const FileView& file, const PlyHeader& header)
      : file_(file), header_(header), row_{file}, body_(file, header, row_), builder_(file) {}

  Mesh read() {
    for (const PlyElement& element : header_.elements)
      if (element.name == "vertex") vertex_count_ = element.count;
    for (const PlyElement& element : header_.elements) read_element(element);
    return builder_.finish([](std::size_t v) { return "vertex " + std::to_string(v); });
  }

 private:
  void read_element(const PlyElement& element) {
    row_.element = &element;
    row_.number = 0;
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face",
               is_strips = element.name == "tristrips";
    const std::uint64_t least = element.least_bytes(Body::kAscii);
    // Rows without content need no loop, however many the header claims. Vertices and faces without any are refused
    // below.
    if (least == 0 && !is_vertex && !is_face && !is_strips) return;
    check_count(file_, element, body_);
    if (is_vertex)
      read_vertices(element);
    else if (is_face)
      read_faces(element);
    else if (is_strips)
      read_strips(element);
    else
      for_each_row(element, [&](const PlyProperty& property) { skip(property); });
  }

  template <class ReadProperty>
  void for_each_row(const PlyElement& element, const ReadProperty& read_property) {
    for (row_.number = 0; row_.number < element.count; ++row_.number) {
      if (row_.number % 4096 == 0) file_.check();
      for (const PlyProperty& property : element.properties) read_property(property);
      body_.end_row();
    }
  }

  void skip(const PlyProperty& property) { skip_property(body_, row_, property); }
  std::uint64_t list_length(const PlyProperty& property) { return standoff::list_length(body_, row_, property); }

  void read_vertices(const PlyElement& element) {
    const std::array<int, 3> axes = position_axes(file_, element);
    builder_.vertices.resize(element.count);
    for (row_.number = 0; row_.number < element.count; ++row_.number) {
      if (row_.number % 4096 == 0) file_.check();
      builder_.vertices[row_.number] = read_position(body_, row_, axes);
    }
  }

  // The list of vertices of each row of an element.
  const PlyProperty& corners_of(const PlyElement& element) const {
    int corners = element.find("vertex_indices");
    if (corners < 0) corners = element.find("vertex_index");
    const PlyProperty* list = corners < 0 ? nullptr : &element.properties[static_cast<std::size_t>(corners)];
    if (!list || !list->list || list->type >= StoredType::float32)
      file_.fail("header", "element " + element.name +
                               " needs a list of integers called vertex_indices; write the file again with one");
    return *list;
  }

  void read_faces(const PlyElement& element) {
    const PlyProperty& list = corners_of(element);
    builder_.triangles.reserve(element.count);
    std::vector<std::uint32_t> face;
    for_each_row(element, [&](const PlyProperty& property) {
      if (&property != &list) return skip(property);
      face.resize(list_length(property));
      for (auto& corner : face) corner = index(body_.template value<std::int64_t>(property.type));
      builder_.add_face(face);
    });
  }

  // Strips of triangles, as scans of Stanford's have them: all in one list, with -1 between one and the next. Every
  // other triangle of a strip turns the other way round, and is turned back here.
  void read_strips(const PlyElement& element) {
    const PlyProperty& list = corners_of(element);
    for_each_row(element, [&](const PlyProperty& property) {
      if (&property != &list) return skip(property);
      std::array<std::uint32_t, 2> before{};
      std::uint64_t corners = 0;  // of this strip, so far
      for (std::uint64_t left = list_length(property); left > 0; --left) {
        const auto value = body_.template value<std::int64_t>(property.type);
        if (value == -1) {
          corners = 0;
          continue;
        }
        const std::uint32_t corner = index(value);
        if (++corners > 2)
          builder_.triangles.push_back(corners % 2 == 1 ? Triangle{before[0], before[1], corner}
                                                        : Triangle{before[1], before[0], corner});
        before = {before[1], corner};
      }
    });
  }

  std::uint32_t index(std::int64_t value) {
    if (value < 0 || static_cast<std::uint64_t>(value) >= vertex_count_)
      row_.fail("vertex index " + std::to_string(value) + " is out of range, there are " +
                std::to_string(vertex_count_) + " vertices; repair the mesh");
    return static_cast<std::uint32_t>(value);
  }

  const FileView& file_;
  const PlyHeader& header_;
  PlyRow row_;
  Body body_;
  MeshBuilder builder_;
  std::uint64_t vertex_count_ = 0;
};

Mesh read_ply(const FileView& file) {
  const PlyHeader header = read_ply_header(file);
  switch (header.encoding) {
    case PlyHeader::Encoding::little_endian:
      return PlyReader<PlyBinaryBody<false>>(file, header).read();
    case PlyHeader::Encoding::big_endian:
      return PlyReader<PlyBinaryBody<true>>(file, header).read();
    case PlyHeader::Encoding::ascii:
      break;
  }
  return PlyReader<PlyAsciiBody>(file, header).read();
}

static_assert(std::endian::native == std::endian::little);

// True where a float holds c: its last 29 bits are zero, and its size is that of a normal float. Asked of the bits, as
// GCC 12 may drop the rounding from (double)(float)c when it packs several of them into one register.
bool is_float(double c) {
  const double size = std::abs(c);
  const bool in_range = size >= std::numeric_limits<float>::min() && size <= std::numeric_limits<float>::max();
  return c == 0 || (in_range && (std::bit_cast<std::uint64_t>(c) & ((1u << 29) - 1)) == 0);
}

bool all_floats(MeshView mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                     [](const Vec3& v) { return is_float(v.x) && is_float(v.y) && is_float(v.z); });
}

template <class Number>
void write_vertices(AtomicFile& file, MeshView mesh) {
  for (const Vec3& v : mesh.vertices) {
    const std::array<Number, 3> stored{static_cast<Number>(v.x), static_cast<Number>(v.y), static_cast<Number>(v.z)};
    file.write(stored.data(), sizeof stored);
  }
}

// Floats where they lose nothing, which halves the file; doubles otherwise.
void write_ply(AtomicFile& file, MeshView mesh) {
  const bool floats = all_floats(mesh);
  const std::string type = floats ? "float" : "double";
  const std::string header = "ply\nformat binary_little_endian 1.0\ncomment written by standoff\nelement vertex " +
                             std::to_string(mesh.vertices.size()) + "\nproperty " + type + " x\nproperty " + type +
                             " y\nproperty " + type + " z\nelement face " + std::to_string(mesh.triangles.size()) +
                             "\nproperty list uchar uint vertex_indices\nend_header\n";
  file.write(header.data(), header.size());
  if (floats)
    write_vertices<float>(file, mesh);
  else
    write_vertices<double>(file, mesh);
  for (const Triangle& t : mesh.triangles) {
    std::array<char, 1 + sizeof t> record{3};
    std::memcpy(record.data() + 1, t.data(), sizeof t);
    file.write(record.data(), record.size());
  }
}

}  // namespace

constinit const MeshFormat kMeshPly{"ply",  "PLY",           "PLY, binary or ASCII; written as binary little endian",
                                    is_ply, as_is<read_ply>, as_they_are<write_ply>};

}  // namespace standoff
