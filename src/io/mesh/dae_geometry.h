// SPDX-License-Identifier: Apache-2.0
// The geometries of a COLLADA file.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/text.h"
#include "standoff/mesh.h"

namespace standoff {

/// A list of faces: the vertices that it uses, in the order of their first use, and polygons of them.
struct ColladaPart {
  std::vector<Vec3> vertices;
  std::vector<std::uint32_t> corners;  ///< of all polygons, one after the other
  std::vector<std::uint32_t> sizes;    ///< corners of each polygon; empty: all are triangles
  std::size_t triangles = 0;           ///< that the polygons become
};

struct ColladaGeometry {
  std::vector<ColladaPart> parts;
  std::size_t vertices = 0, triangles = 0;  ///< of all parts
};

/// Reads elements <geometry>: their positions and faces. Normals, colours and texture coordinates are not looked at.
/// Errors: input, with the line, where arrays, counts and indices do not fit each other.
class ColladaGeometries {
 public:
  ColladaGeometries(const FileView& file, XmlScan& scan, XmlElements& elements)
      : file_(file), scan_(scan), elements_(elements) {}

  /// Reads the element. Of several with one id the first one counts.
  void read(const XmlTag& tag);
  /// nullptr where there is none.
  const ColladaGeometry* find(const std::string& id) const;

 private:
  struct Array {
    XmlTag tag;
    std::uint64_t count;
  };
  struct Accessor {
    std::string array;
    std::uint64_t count, stride, offset;
    std::uint64_t params = 0;
    std::uint64_t place[3] = {0, 1, 2};  // of x, y, z among the values of an entry
  };
  struct Primitive {
    std::string kind;
    std::uint64_t count = 0, offsets = 1, vertex_offset = 0;
    std::string vertices;  // what the input VERTEX names
    bool has_vertices = false;
    std::uint64_t lists = 0;            // elements <p>
    std::vector<std::uint32_t> sizes;   // of <vcount>
    std::uint64_t corners = 0;          // the sum of these
    std::vector<std::uint32_t> number;  // of each position among the vertices of the part
  };

  void read_mesh(const XmlTag& mesh, ColladaGeometry& geometry);
  void read_source(const XmlTag& source);
  void read_accessor(const XmlTag& tag, const std::string& source);
  void read_vertices(const XmlTag& tag);
  void read_primitive(const XmlTag& tag, ColladaGeometry& geometry);
  void read_input(const XmlTag& tag, Primitive& primitive) const;
  void read_sizes(const XmlTag& tag, Primitive& primitive) const;
  std::vector<std::uint32_t> read_corners(const XmlTag& tag, Primitive& primitive, ColladaPart& part);
  void check_lists(const Primitive& primitive) const;
  void check_indices(const Primitive& primitive, std::uint64_t indices) const;
  void find_positions(const Primitive& primitive);
  std::vector<double> numbers_of(const std::string& array) const;

  template <class See>
  void each_whole(const XmlTag& tag, const See& see) const;
  std::uint64_t whole(const XmlTag& tag, std::string_view attribute, std::uint64_t otherwise) const;

  const FileView& file_;
  XmlScan& scan_;
  XmlElements& elements_;
  std::map<std::string, Array> arrays_;
  std::map<std::string, Accessor> accessors_;  // by their source
  std::map<std::string, ColladaGeometry> geometries_;
  // Of the mesh at hand: its element <vertices>, and the positions that it names once they are used.
  std::optional<std::string> vertices_id_;
  std::string positions_source_;
  std::optional<std::vector<Vec3>> positions_;
};

/// What an attribute that refers to an element of the file names, without its #; nothing where it refers elsewhere.
std::optional<std::string> id_in(std::string_view reference);

/// The next word of a text, up to a space; empty at its end.
std::string_view take_xml_word(std::string_view& text);

/// The double that is the whole word, infinite where it is too large. Its point may be a comma, which some programs
/// write where that is the custom of the country.
std::optional<double> double_in(std::string_view word);

}  // namespace standoff
