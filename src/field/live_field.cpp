// SPDX-License-Identifier: Apache-2.0
// A field that follows its mesh: keeps what updates have in common.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/guarded.h"
#include "core/memory.h"
#include "core/mesh_copy.h"
#include "core/threads.h"
#include "field/computation.h"
#include "field/field_update.h"
#include "field/mesh_parts.h"
#include "field/prepare.h"
#include "geometry/triangle_box.h"
#include "standoff/update.h"

namespace standoff {

// What is kept of the mesh between updates. Not in an unnamed namespace, as LiveField::Work holds it.

// Each part is made when it is first asked for, of the mesh as it is then, and follows it from there on.
class KeptFacts final : public MeshFacts {
 public:
  // The mesh keeps its triangles, and stays where it is. Crossings that take more than so many bytes are not kept, but
  // found again for each window.
  KeptFacts(MeshView mesh, std::int64_t most_of_crossings) : mesh_(mesh), most_of_crossings_(most_of_crossings) {}

  static std::int64_t bytes(std::int64_t triangles, std::int64_t vertices) {
    return MeshParts::bytes(triangles) + MeshParts::following_bytes(triangles) +
           OutwardSums::bytes(triangles, vertices);
  }

  // Whether follow() was called since the last call of this.
  bool take_follows() { return std::exchange(follows_, false); }
  // What was in vain may be tried again: beside computing anew it takes little.
  void try_again() { tries_sums_ = tries_crossings_ = true; }

  // All other triangles were checked when they last moved.
  void check(const MeshChange& change, const Plan& plan) override {
    const FloatRange near(plan.grid);
    for (const std::uint32_t triangle : change.triangles)
      for (const Vec3& corner : mesh_.corners(triangle))
        if (!near.holds(corner)) return check_domain(mesh_, plan.grid);
  }

  void follow(const MeshChange& change, const ChangedCrossings& crossings) override {
    follows_ = true;
    if (edges_) {
      edges_before_ = *edges_;
      *edges_ -= EdgeSums(change.before, change.triangles);
      *edges_ += EdgeSums(change.after, change.triangles);
    }
    if (outwards_) outwards_->follow(change.before, change.after, change.triangles);
    if (signs_) signs_->follow(crossings);
    if (parts_ && !parts_->follow(mesh_, change.triangles)) parts_.reset();
  }

  Closed closed(const MeshChange& change) override {
    if (!edges_) {
      edges_.emplace(mesh_);
      edges_before_ = *edges_;
      edges_before_ -= EdgeSums(change.after, change.triangles);
      edges_before_ += EdgeSums(change.before, change.triangles);
    }
    const Closed before = edges_before_.closed(), after = edges_->closed();
    return {before.oriented && after.oriented, before.unoriented && after.unoriented};
  }

  // Sums that say nothing for sure are made anew for the next update: their units and origins may have become unfit.
  // Where new ones say nothing either, the pass over the mesh is quicker.
  bool faces_outwards(const MeshChange&) override {
    if (tries_sums_) {
      const bool are_new = !outwards_;
      if (are_new) outwards_.emplace(mesh_);
      if (outwards_->surely_outwards()) return true;
      outwards_.reset();
      tries_sums_ = !are_new;
    }
    return standoff::faces_outwards(mesh_);
  }

  SampleSigns* signs(const Grid& grid, WindingRule rule, ProgressMeter& progress) override {
    const auto most = static_cast<double>(most_of_crossings_);
    if (!signs_ && tries_crossings_ && may_share_rows(grid) && KeptCrossings::expected_bytes({mesh_}, grid) <= most)
      signs_.emplace(OrientedMesh{mesh_}, grid, rule, progress, most_of_crossings_);
    if (signs_ && signs_->bytes() > most_of_crossings_) signs_.reset();
    tries_crossings_ = signs_.has_value();
    return signs_ ? &*signs_ : nullptr;
  }

  std::vector<WindowTriangles> triangles_of(const DirtyTiles& dirty, std::span<const Grid> windows, double reach,
                                            bool with_crossed, ProgressMeter& progress) override {
    const Grid& grid = dirty.grid();
    if (!parts_) parts_.emplace(mesh_, std::span<const std::uint32_t>{}, progress);
    std::vector<WindowTriangles> all(windows.size());
    const double margin = rounding_of_places(grid);
    tbb::parallel_for(std::size_t{0}, windows.size(), [&](std::size_t n) {
      all[n].near = parts_->touching(windows[n].bounds().grown(margin + reach), [&](std::uint32_t triangle) {
        return dirty.any_near(triangle_box(mesh_, triangle).grown(margin + reach));
      });
      if (!with_crossed) return;
      Box box = windows[n].bounds().grown(margin);
      box.min.x = -std::numeric_limits<double>::infinity();
      all[n].crossed = parts_->touching(box);
    });
    return all;
  }

 private:
  MeshView mesh_;
  std::int64_t most_of_crossings_;  // bytes
  bool follows_ = false, tries_sums_ = true, tries_crossings_ = true;
  EdgeSums edges_before_;
  std::optional<EdgeSums> edges_;
  std::optional<OutwardSums> outwards_;
  std::optional<KeptCrossings> signs_;
  std::optional<MeshParts> parts_;
};

// The triangles of each vertex, ascending.
class TrianglesOfVertices {
 public:
  explicit TrianglesOfVertices(const Mesh& mesh) : begin_(mesh.vertices.size() + 1) {
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t) ++begin_[v];
    std::size_t place = 0;
    for (std::size_t& entry : begin_) place += std::exchange(entry, place);
    triangles_.resize(place);
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t v : mesh.triangles[t]) triangles_[next[v]++] = t;
  }
  static std::int64_t bytes(std::int64_t triangles, std::int64_t vertices) {
    return 3 * triangles * std::int64_t{sizeof(std::uint32_t)} + 2 * (vertices + 1) * std::int64_t{sizeof(std::size_t)};
  }

  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(triangles_).subspan(begin_[vertex], begin_[vertex + 1] - begin_[vertex]);
  }

 private:
  std::vector<std::size_t> begin_;  // by vertex
  std::vector<std::uint32_t> triangles_;
};

namespace {

std::int64_t kept_bytes(const MeshView& mesh) {
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size()),
             vertices = static_cast<std::int64_t>(mesh.vertices.size());
  constexpr std::int64_t kCopies = 2 * sizeof(Vec3);
  return triangles * std::int64_t{sizeof(Triangle)} + vertices * kCopies +
         TrianglesOfVertices::bytes(triangles, vertices) + KeptFacts::bytes(triangles, vertices);
}

// The limit less what is kept of the mesh besides crossings; 0 where there is none.
std::int64_t limit_beside(const MeshView& mesh, const ComputeOptions& options) {
  const std::int64_t limit = memory_limit_of(options), kept = kept_bytes(mesh);
  if (limit == 0) return 0;
  if (kept >= limit)
    throw Error(ErrorCode::limit,
                "update: what is kept of the mesh would take " +
                    over_the_limit(static_cast<double>(kept), static_cast<double>(limit)) +
                    "; give a higher limit, or take update_field(), which keeps nothing",
                {.bytes_needed = kept, .bytes_limit = limit});
  return limit - kept;
}

}  // namespace

// The public class.

class LiveField::Work {
 public:
  Work(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options)
      : hashes_(options.hash_mesh), grid_(grid), thickness_(thickness), options_(options) {
    validate(thickness, options);
    validate(grid);
    validate(mesh);
    options_.hash_mesh = false;  // field() hashes
    share_memory(limit_beside(mesh, options));
    now_ = copy_of(mesh);
    before_ = now_.vertices;
    triangles_of_.emplace(now_);
    report_ = compute_into(now_, grid_, thickness_, field_, options_);
    options_.decision = {};  // of this mesh alone
    facts_.emplace(now_, most_of_crossings_);
    FieldUpdate(now_, now_, *facts_, field_, options_).prepare({});
    facts_->take_follows();
  }

  UpdateReport move(std::span<const std::uint32_t> vertices, std::span<const Vec3> positions) {
    check(vertices, positions);
    std::vector<Vec3> apart;  // from the vertices that move
    if (overlap(positions, now_.vertices)) positions = apart = {positions.begin(), positions.end()};
    make_field();
    const std::vector<std::uint32_t> changed = put(vertices, positions);
    try {
      if (!facts_) facts_.emplace(now_, most_of_crossings_);
      const MeshView before{before_, now_.triangles};
      UpdateReport report = FieldUpdate(before, now_, *facts_, field_, options_).run(changed);
      if (report.anew) facts_->try_again();
      if (!facts_->take_follows()) facts_.reset();  // it was computed anew before they were told
      for (const std::uint32_t vertex : vertices) before_[vertex] = now_.vertices[vertex];
      return report;
    } catch (...) {
      if (facts_ && facts_->take_follows()) facts_.reset();  // they follow no mesh that is given up
      for (const std::uint32_t vertex : vertices) now_.vertices[vertex] = before_[vertex];
      throw;
    }
  }

  MeshView mesh() const { return now_; }
  const ComputeReport& report() const { return report_; }

  const DistanceField& field() {
    make_field();
    if (hashes_ && field_.provenance().mesh_hash == 0) {
      Provenance provenance = field_.provenance();
      provenance.mesh_hash = Threads(options_.execution.threads).run([&] { return content_hash(now_); });
      field_.set_provenance(std::move(provenance));
    }
    return field_;
  }

 private:
  // Parts the limit: an eighth is for the crossings that are kept, if any, the rest for each computation.
  void share_memory(std::int64_t limit) {
    if (limit == 0) return;
    most_of_crossings_ = FieldUpdate::by_rows(options_.sign.method) ? limit / 8 : 0;
    options_.memory_limit = limit - most_of_crossings_;
  }

  static bool overlap(std::span<const Vec3> a, std::span<const Vec3> b) {
    const std::less<const Vec3*> before;
    return before(a.data(), b.data() + b.size()) && before(b.data(), a.data() + a.size());
  }

  void check(std::span<const std::uint32_t> vertices, std::span<const Vec3> positions) const {
    if (vertices.size() != positions.size())
      throw Error(ErrorCode::usage, "update: " + std::to_string(vertices.size()) + " vertices move to " +
                                        std::to_string(positions.size()) + " positions; give one for each");
    for (const std::uint32_t vertex : vertices)
      if (vertex >= now_.vertices.size())
        throw Error(ErrorCode::usage, "update: vertex " + std::to_string(vertex) + " does not exist, there are " +
                                          std::to_string(now_.vertices.size()) + "; name vertices of the mesh");
  }

  // It is empty only after an update that failed late.
  void make_field() {
    if (field_.slots().empty()) compute_into(now_, grid_, thickness_, field_, options_);
  }

  // Moves vertices; returns the triangles with other corners than before.
  std::vector<std::uint32_t> put(std::span<const std::uint32_t> vertices, std::span<const Vec3> positions) {
    std::vector<std::uint32_t> changed;
    for (std::size_t n = 0; n < vertices.size(); ++n)
      if (std::memcmp(&before_[vertices[n]], &positions[n], sizeof(Vec3)) != 0)
        for (const std::uint32_t triangle : triangles_of_->of(vertices[n])) changed.push_back(triangle);
    std::ranges::sort(changed);
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    for (std::size_t n = 0; n < vertices.size(); ++n) now_.vertices[vertices[n]] = positions[n];
    return changed;
  }

  bool hashes_;
  Grid grid_;
  double thickness_;
  ComputeOptions options_;  // of each computation
  std::int64_t most_of_crossings_ = std::numeric_limits<std::int64_t>::max();
  Mesh now_;
  std::vector<Vec3> before_;  // vertices; other than those now only while they move
  std::optional<TrianglesOfVertices> triangles_of_;
  DistanceField field_;
  ComputeReport report_;
  std::optional<KeptFacts> facts_;
};

LiveField::LiveField(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options) try
    : work_(std::make_unique<Work>(mesh, grid, thickness, options)) {
} catch (...) {
  throw_as_error("update", kWithLessMemory);
}

LiveField::LiveField(LiveField&&) noexcept = default;
LiveField& LiveField::operator=(LiveField&&) noexcept = default;
LiveField::~LiveField() = default;

UpdateReport LiveField::move(std::span<const std::uint32_t> vertices, std::span<const Vec3> positions) try {
  return work_->move(vertices, positions);
} catch (...) {
  throw_as_error("update", kWithLessMemory);
}

MeshView LiveField::mesh() const { return work_->mesh(); }

const DistanceField& LiveField::field() try { return work_->field(); } catch (...) {
  throw_as_error("update", kWithLessMemory);
}

const ComputeReport& LiveField::report() const { return work_->report(); }

}  // namespace standoff
