// SPDX-License-Identifier: Apache-2.0
// A 3D model part of a .3mf file: its objects, and what it builds of them. 3MF Core Specification 1.3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

#include "files/file_view.h"
#include "files/xml_scan.h"
#include "io/mesh/scene.h"
#include "standoff/mesh.h"

namespace standoff {

/// An object placed in another one, or in the build. Points into the part's text.
struct ThreemfReference {
  XmlTag tag;
  std::uint32_t object;
  std::string_view path;  ///< of the part that holds the object; empty: this part
};

struct ThreemfObject {
  /// Indices into the lists of the model: [first, end).
  struct Range {
    std::size_t first = 0, end = 0;
    std::size_t size() const { return end - first; }
  };
  Range vertices, triangles, components;
};

/// Everything is copied out of the text, or points into it.
class ThreemfModel {
 public:
  /// Errors: input, as `FILE:PART:line N: ...`. The part must outlive it.
  explicit ThreemfModel(const FileView& part);

  /// Throws with the reference's line where there is no such object.
  const ThreemfObject& find(const ThreemfReference& reference, const ThreemfModel& from) const;
  /// Where a reference of this model places its object. Errors: input.
  Placement placement(const ThreemfReference& reference) const;
  /// Throws with the line of a reference of this model.
  [[noreturn]] void fail_at(const ThreemfReference& reference, const std::string& message) const {
    scan_.fail_at(reference.tag, message);
  }

  double metres_per_unit = 0.001;
  std::vector<ThreemfReference> build;
  std::vector<ThreemfReference> components;  ///< of all objects
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;  ///< their corners count from the object's first vertex

 private:
  void check_extensions(const XmlTag& model) const;
  void read_unit(const XmlTag& model);
  void read_object(const XmlTag& tag);
  void read_mesh(const XmlTag& tag, ThreemfObject& object);
  void read_vertex(const XmlTag& tag);
  void read_triangle(const XmlTag& tag, std::size_t vertices);
  void read_reference(const XmlTag& tag, std::vector<ThreemfReference>& to);
  double coordinate(const XmlTag& tag, std::string_view name) const;
  std::uint32_t whole(const XmlTag& tag, std::string_view name) const;

  XmlScan scan_;
  XmlElements elements_;
  std::map<std::uint32_t, ThreemfObject> objects_;
};

}  // namespace standoff
