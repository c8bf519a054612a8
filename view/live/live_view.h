// SPDX-License-Identifier: Apache-2.0
// A mesh whose field is computed anew as often as somebody changes what it should be.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "standoff/compute.h"
#include "standoff/page.h"
#include "standoff/points.h"
#include "standoff/sign.h"

namespace standoff::view {

struct LiveSettings {
  std::int64_t samples = 128;  ///< along the longest side
  double thickness = kFullField;
  bool thickness_in_samples = false;  ///< or else in world units
  SignOptions sign = {};
  Execution execution = {};

  friend bool operator==(const LiveSettings& a, const LiveSettings& b) {
    return a.samples == b.samples && a.thickness == b.thickness && a.thickness_in_samples == b.thickness_in_samples &&
           a.sign.method == b.sign.method && a.sign.shell == b.sign.shell &&
           a.execution.backend == b.execution.backend && a.execution.device == b.execution.device;
  }
};

/// All members may be called from several threads.
class LiveView {
 public:
  LiveView(std::string name, Mesh mesh, const LiveSettings& settings, std::int64_t memory_limit);

  struct Subject {
    std::string name;
    std::shared_ptr<const Mesh> mesh;
    std::uint64_t version = 0;  ///< grows with each mesh
  };
  Subject subject() const;
  /// What was asked for last.
  LiveSettings settings() const;
  /// Another mesh in place of this one. What is being computed ends.
  void replace(std::string name, Mesh mesh);

  /// The field, as pages hold it. Ends what was asked for before, and is ended itself, with nothing, by what is asked
  /// for next, or once `abandoned()`. Errors: as compute().
  std::optional<std::string> field(const LiveSettings& settings, const std::function<bool()>& abandoned);
  /// How the sign of the last field was decided.
  SignReport sign() const;
  /// How far the field that is being computed has come.
  struct Stage {
    const char* name = "";
    double fraction = 0;
    bool operator==(const Stage&) const = default;
  };
  Stage stage() const;

  /// The exact answer at a point, with the sign of the settings where points have it (not flood), and its gradient.
  struct At {
    ClosestPoint closest;
    Vec3 gradient;
  };
  At at(Vec3 point);

 private:
  std::shared_ptr<const MeshQuery> query();

  const std::int64_t memory_limit_;
  std::atomic<std::uint64_t> latest_{0};  // counts what was asked for; what is not the latest ends

  mutable std::mutex mutex_;  // the members below
  Subject subject_;
  LiveSettings settings_;
  Stage stage_;
  SignReport sign_;

  std::mutex asking_;  // the next three
  std::shared_ptr<const MeshQuery> query_;
  std::uint64_t query_version_ = 0;
  SignMethod query_sign_ = SignMethod::none;

  std::mutex computing_;  // and the field, whose memory is used again
  DistanceField field_;
};

}  // namespace standoff::view
