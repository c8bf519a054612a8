// SPDX-License-Identifier: Apache-2.0
// 3MF: the triangles of what a file builds, where its items and components place them.
#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "io/mesh/builder.h"
#include "io/mesh/format.h"
#include "io/mesh/scene.h"
#include "io/mesh/threemf_model.h"
#include "io/mesh/threemf_package.h"

namespace standoff {
namespace {

// Beyond any build that was meant. Each level takes a frame of the reader's stack; each placed object half a
// microsecond, also where it holds no triangle.
constexpr int kDeepestComponent = 200;
constexpr double kMostPlaced = 1e6;

class Build {
 public:
  Build(const FileView& file, ThreemfPackage& package)
      : file_(file), package_(package), root_(load(package.model())), builder_(file) {}

  double metres_per_unit() const { return root_.metres_per_unit; }

  Mesh read(const Placement& outer) {
    Size all;
    for (const ThreemfReference& item : root_.build) add(all, root_, item, 0);
    check_unfolded(file_, {all.vertices, all.triangles}, file_.size() + package_.unpacked());
    check_counts(file_, static_cast<std::uint64_t>(all.vertices), static_cast<std::uint64_t>(all.triangles));
    builder_.vertices.reserve(static_cast<std::size_t>(all.vertices));
    builder_.triangles.reserve(static_cast<std::size_t>(all.triangles));
    for (const ThreemfReference& item : root_.build) place(root_, item, outer);
    return builder_.finish([this](std::size_t vertex) { return where(vertex); });
  }

 private:
  // Of an object with all that its components place.
  struct Size {
    double vertices = 0, triangles = 0, placed = 0;
    int height = 0;
    bool entered = false, known = false;
  };
  // Vertices of the builder from `first` on are those of an object.
  struct Origin {
    std::size_t first;
    std::uint32_t object;
  };

  const ThreemfModel& load(const FileView& part) {
    auto& model = models_[&part];
    if (!model) model = std::make_unique<ThreemfModel>(part);
    return *model;
  }

  const ThreemfModel& model_of(const ThreemfReference& reference, const ThreemfModel& from) {
    return reference.path.empty() ? from : load(package_.part(reference.path));
  }

  void add(Size& sum, const ThreemfModel& from, const ThreemfReference& reference, int depth) {
    const ThreemfModel& model = model_of(reference, from);
    const ThreemfObject& object = model.find(reference, from);
    Size& size = sizes_[&object];
    if (!size.known) {
      if (size.entered) from.fail_at(reference, "an object is a component of itself; repair the file");
      if (depth > kDeepestComponent) fail_for_depth(from, reference);
      size.entered = true;
      Size inner{double(object.vertices.size()), double(object.triangles.size()), 1};
      for (std::size_t c = object.components.first; c < object.components.end; ++c)
        add(inner, model, model.components[c], depth + 1);
      size = inner;
      size.known = true;
    }
    if (size.height + depth > kDeepestComponent) fail_for_depth(from, reference);
    sum.height = std::max(sum.height, size.height + 1);
    sum.vertices += size.vertices;
    sum.triangles += size.triangles;
    sum.placed += size.placed;
    if (sum.placed > kMostPlaced)
      from.fail_at(reference, "its items and components place more than 1000000 objects; place fewer");
  }

  [[noreturn]] static void fail_for_depth(const ThreemfModel& from, const ThreemfReference& reference) {
    from.fail_at(reference,
                 "components are nested more than " + std::to_string(kDeepestComponent) + " deep; flatten them");
  }

  void place(const ThreemfModel& from, const ThreemfReference& reference, const Placement& outer) {
    const ThreemfModel& model = model_of(reference, from);
    const ThreemfObject& object = model.find(reference, from);
    const Placement placement = outer * from.placement(reference);
    // What was outside stays outside.
    const bool mirrored = placement.mirrors();
    const auto first = static_cast<std::uint32_t>(builder_.vertices.size());
    if (object.vertices.size() > 0) origins_.push_back({first, reference.object});
    for (std::size_t v = object.vertices.first; v < object.vertices.end; ++v)
      builder_.vertices.push_back(placement(model.vertices[v]));
    for (std::size_t t = object.triangles.first; t < object.triangles.end; ++t) {
      auto [a, b, c] = model.triangles[t];
      if (mirrored) std::swap(b, c);
      builder_.triangles.push_back({first + a, first + b, first + c});
    }
    for (std::size_t c = object.components.first; c < object.components.end; ++c)
      place(model, model.components[c], placement);
  }

  std::string where(std::size_t vertex) const {
    const auto after = std::ranges::upper_bound(origins_, vertex, {}, &Origin::first);
    if (after == origins_.begin()) return "vertex " + std::to_string(vertex);
    const Origin& origin = *std::prev(after);
    return "object " + std::to_string(origin.object) + " vertex " + std::to_string(vertex - origin.first);
  }

  const FileView& file_;
  ThreemfPackage& package_;
  std::map<const FileView*, std::unique_ptr<ThreemfModel>> models_;
  const ThreemfModel& root_;
  std::map<const ThreemfObject*, Size> sizes_;
  MeshBuilder builder_;
  std::vector<Origin> origins_;
};

}  // namespace

// Names stand in an archive as they are.
bool is_3mf(std::string_view content) {
  return content.starts_with("PK\x03\x04") && content.find(".model") != content.npos &&
         content.find("_rels/.rels") != content.npos;
}

Mesh read_3mf(const FileView& file, MeshReadReport& report) {
  ThreemfPackage package(file);
  Build build(file, package);
  // As for 3DS and COLLADA: from z up to y up, in metres.
  const double scale = build.metres_per_unit();
  Mesh mesh = build.read({{{{scale, 0, 0, 0}, {0, 0, scale, 0}, {0, -scale, 0, 0}}}});
  report.axes = {1, 3, -2};
  report.unit_scale = scale;
  report.metres_per_unit = 1;
  return mesh;
}

}  // namespace standoff
