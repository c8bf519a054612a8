// SPDX-License-Identifier: Apache-2.0
// One update of a field after a part of its mesh moved: which windows can change, their samples, and how they get into
// the field.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "field/dirty.h"
#include "field/plan.h"
#include "sign/diagnosis/closed.h"
#include "sign/plan.h"
#include "sign/rows/changed_crossings.h"
#include "sign/signs.h"
#include "standoff/update.h"

namespace standoff {

/// What an update asks of the whole mesh: answered by passes over it, or from what is kept between updates. All run on
/// the threads of the calling TBB arena, in this order, and each at most once an update.
class MeshFacts {
 public:
  MeshFacts() = default;
  MeshFacts(const MeshFacts&) = delete;
  MeshFacts& operator=(const MeshFacts&) = delete;
  virtual ~MeshFacts() = default;

  /// Throws as validate() and check_domain() do of the mesh after.
  virtual void check(const MeshChange& change, const Plan& plan) = 0;
  /// Tells what changes. `crossings`: empty where the sign is not by rows.
  virtual void follow([[maybe_unused]] const MeshChange& change, [[maybe_unused]] const ChangedCrossings& crossings) {}
  /// In what way both meshes are closed.
  virtual Closed closed(const MeshChange& change) = 0;
  /// faces_outwards() of the mesh after, which is closed.
  virtual bool faces_outwards(const MeshChange& change) = 0;
  /// The signs of all rows of the grid by the plan's method, winding or parity, if they are kept; else nullptr.
  virtual SampleSigns* signs([[maybe_unused]] const Grid& grid, [[maybe_unused]] WindingRule rule,
                             [[maybe_unused]] ProgressMeter& progress) {
    return nullptr;
  }
  /// As standoff::triangles_of(), of the mesh after.
  virtual std::vector<WindowTriangles> triangles_of(const DirtyTiles& dirty, std::span<const Grid> windows,
                                                    double reach, bool with_crossed, ProgressMeter& progress) = 0;
};

class FieldUpdate {
 public:
  /// As update_field(). All must outlive this.
  FieldUpdate(MeshView before, MeshView after, MeshFacts& facts, DistanceField& field, const ComputeOptions& options);

  UpdateReport run(std::span<const std::uint32_t> changed);
  /// The first steps of run() alone, after which the field is as before: what the facts keep is ready then.
  void prepare(std::span<const std::uint32_t> changed);
  /// Whether crossings of rows decide the sign, where windows can do.
  static bool by_rows(SignMethod method) { return method != SignMethod::none && method != SignMethod::shell; }

 private:
  // The tiles of a window, as they will be: as DistanceField::slots(), and the arrays that slots point into.
  struct NewWindow {
    Grid grid;
    std::vector<std::int32_t> slots;
    std::vector<float> values;
    std::vector<std::uint32_t> nearest;

    void copy(const DistanceField& field);
  };
  friend class TileMerge;

  std::string find_out(std::span<const std::uint32_t> changed);
  void check_field() const;
  void hash_mesh();
  std::string global_reason() const;
  std::string find_change(std::span<const std::uint32_t> changed);
  std::string find_windows();
  void check_windows() const;
  std::string decide_sign();
  void find_triangles();
  void compute(const WindowTriangles& triangles, const Grid& window, DistanceField& field);
  void sign(const WindowTriangles& triangles, DistanceField& field);
  void merge();
  void compute_anew(std::string why);
  Size3 largest_window() const;

  WindingRule rule() const { return sign_.report.method == SignMethod::parity ? WindingRule::odd : options_.sign.rule; }

  const MeshView before_, after_;
  MeshFacts& facts_;
  DistanceField& field_;
  ComputeOptions options_;
  ProgressMeter progress_;
  MeshChange change_;
  ChangedCrossings crossings_;
  std::optional<Plan> plan_;
  std::optional<DirtyTiles> dirty_;
  SignPlan sign_;
  SampleSigns* kept_signs_ = nullptr;
  std::uint64_t hash_ = 0;  // of the new mesh
  std::vector<NewWindow> windows_;
  std::vector<WindowTriangles> triangles_;  // by window
  UpdateReport report_;
};

}  // namespace standoff
