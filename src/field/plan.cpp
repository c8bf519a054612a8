// SPDX-License-Identifier: Apache-2.0
// Plans a computation and bounds its memory.
#include "field/plan.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/guarded.h"
#include "core/memory.h"
#include "core/number_text.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "field/lattice.h"
#include "field/mesh_parts.h"
#include "field/prepare.h"
#include "field/skip.h"
#include "sign/methods.h"
#include "sign/open_winding/open_winding.h"
#include "sign/plan.h"
#include "sign/rows/row_crossings.h"
#include "sign/sign_field.h"
#include "sign/signs.h"

namespace standoff {

void validate(double thickness, const ComputeOptions& options) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("compute: ") + what); };
  if (!(thickness > 0)) fail("the thickness must be positive; infinity gives a full field");
  validate("compute", options.execution, Runs::everywhere);
  if (options.skip.kind == SkipRule::Kind::neighbour && !(options.skip.fraction > 0 && options.skip.fraction <= 1))
    fail("the neighbour rule's fraction must be above 0 and at most 1; 1 is the thesis's");
  // A caller may have cast any number to an enumeration.
  const auto one_of = [](auto value, auto last) { return value >= decltype(value){} && value <= last; };
  if (!find_info(options.method) || !one_of(options.skip.kind, SkipRule::Kind::exact))
    fail("there is no such method or skip rule; take one of enum Method and of SkipRule::Kind");
  if (!options.devices.empty() && !find_info(options.execution.backend)->has_devices)
    fail("devices are GPUs by their numbers; take Backend::cuda with them, or name none");
  for (auto at = options.devices.begin(); at != options.devices.end(); ++at) {
    const std::string device = "compute: device " + std::to_string(*at);
    if (*at < 0) throw Error(ErrorCode::usage, device + " does not exist; devices are counted from 0");
    if (std::find(options.devices.begin(), at, *at) != at)
      throw Error(ErrorCode::usage, device + " is named twice; name each once");
  }
  if (std::isinf(thickness) && !find_info(options.method)->full_fields)
    throw Error(ErrorCode::usage, std::string("compute: the method ") + find_info(options.method)->name +
                                      " has no full fields; give a finite thickness, or take the method tiles");
  validate(options.sign);
}

Size3 slab_size(const Grid& grid, std::int64_t samples) {
  if (samples < 1)
    throw Error(ErrorCode::usage,
                "compute: a slab of " + std::to_string(samples) + " samples holds nothing; give 1 or more");
  const std::int64_t layers = std::max<std::int64_t>(1, samples / (grid.size.x * grid.size.y) / kBrickSide);
  return {grid.size.x, grid.size.y, std::min(grid.size.z, kBrickSide * layers)};
}

SkipRule effective_rule(const ComputeOptions& options) {
  if (options.skip.kind != SkipRule::Kind::automatic) return options.skip;
  return {options.method == Method::thesis ? SkipRule::Kind::neighbour : SkipRule::Kind::none, 1};
}

namespace {

// The largest distance that must be known. Beyond the limit, float could not tell it from half of the shell.
double reach(const Grid& grid, double thickness, const SignOptions& sign) {
  if (sign.method != SignMethod::shell) return thickness;
  const double most = std::min(0x1p20 * grid.max_spacing(), 0x1p120);
  if (sign.shell > most)
    throw Error(ErrorCode::limit,
                "compute: a shell of thickness " + number_text(sign.shell) + " is more than " + number_text(most) +
                    " thick, where values in float would be coarser than the grid; give a thinner one");
  return Shell::reach(sign.shell, thickness);
}

std::vector<int> devices_of(const ComputeOptions& options, const BackendRow& row) {
  if (options.devices.empty()) return {options.execution.device};
  if (options.devices.size() > 1 && !row.on_several_devices)
    throw Error(ErrorCode::usage, std::string("compute: the method ") + find_info(row.method)->name + " takes one " +
                                      name_of(row.backend) + " device; name one, or take the method tiles on GPUs");
  return options.devices;
}

// Whether a backend may decide the sign. A decision that must be certain, or is there already, comes before any
// distance. A tile that is not stored must be on one side: no triangle near it may be left out, and no band is thinner
// than the way from a sample to the next.
bool is_sign_by(const BackendRow& row, const Grid& grid, double thickness, const ComputeOptions& options) {
  return row.decides_signs && is_sign_on_device(options.sign) && !options.sign.strict && options.decision.empty() &&
         effective_rule(options).kind != SkipRule::Kind::neighbour && thickness >= grid.max_spacing();
}

}  // namespace

Plan make_plan(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options, bool is_dense,
               const Size3& window) {
  if (!begins_at_brick(grid))
    throw Error(ErrorCode::usage,
                "compute: the grid is a window that begins at no multiple of 16 samples of its whole; give the whole "
                "grid to WindowComputation, which computes any window");
  const BackendRow& row = find_backend(options.execution.backend, options.method, triangles, grid);
  const bool in_windows = window.count() != 0 && window != grid.size && !find_info(options.method)->spreads &&
                          steps_of(options.sign.method).scope != SignScope::field;
  return {&row,
          effective_rule(options),
          options.method == Method::tiles && options.skip.kind == SkipRule::Kind::automatic,
          triangles,
          grid,
          reach(grid, thickness, options.sign),
          thickness,
          thread_count(options.execution.threads),
          options.nearest || steps_of(options.sign.method).needs_nearest,
          options.sign.method != SignMethod::none,
          !in_windows && is_sign_by(row, grid, thickness, options),
          is_dense,
          in_windows,
          in_windows ? window : grid.size,
          devices_of(options, row)};
}

void take_whole(Plan& plan) {
  plan.in_windows = false;
  plan.part = plan.grid.size;
}

namespace {

// Bytes that the backend holds beside the output.
std::int64_t scratch_bytes(const Plan& plan, double brick_refs = std::numeric_limits<double>::infinity()) {
  // Several devices work on parts of the grid. A method with windows of its own may prepare the whole grid for them.
  const auto devices = static_cast<std::int64_t>(plan.devices.size());
  const bool whole = plan.row->prepares_whole && plan.row->prepares_whole(plan.triangles, plan.grid, plan.thickness);
  Grid part = plan.grid;
  if (!whole) part.size = plan.part;
  if (devices > 1) part.size.z = std::min(part.size.z, kBrickSide * (part.size.z / kBrickSide / devices + 1));
  return devices * plan.row->scratch_bytes({plan.triangles, brick_refs, plan.sign_by_backend}, part, plan.thickness,
                                           plan.threads);
}

// Bytes that deciding the sign takes beside the output and the crossings. Crossings that fit at once are not found row
// by row.
std::int64_t sign_bytes(const Plan& plan, bool crossings_fit = false) {
  Grid part = plan.grid;
  if (!may_share_rows(plan.grid)) part.size = plan.part;
  return RowCrossings::other_bytes(crossings_fit ? 0 : plan.triangles, part, plan.threads) +
         plan.threads * InsideRows::bytes(part);
}

// The tiles of the grid, or of a window.
double tiles_at_once(const Plan& plan) { return static_cast<double>(tile_count(plan.part)); }

// Bytes of crossings in memory at once, in windows: there the backend keeps its memory meanwhile. The value is a
// choice.
constexpr std::int64_t kCrossingBytesInWindows = std::int64_t{32} << 20;

// A decision that is there already was made by a plan, which it keeps.
SignMemory sign_memory_of(MeshView mesh, const Plan& plan, const ComputeOptions& options) {
  SignMemory memory = sign_memory(mesh, options.sign, plan.threads);
  if (!options.decision.empty()) memory.planning = memory.kept;
  return memory;
}

// What the sign of an open mesh takes beside the crossings of a closed one: the caps, and their crossings.
std::int64_t open_sign_bytes(const Plan& plan, const SignMemory& sign) {
  return sign.boundary == 0 ? 0 : OpenWinding::bytes(sign.boundary, plan.part, plan.threads);
}

// Advice for a computation that does not fit: only settings that would fit are named.
class Advice {
 public:
  Advice(MeshView mesh, const Plan& plan, const ComputeOptions& options, const SignMemory& sign)
      : mesh_(mesh), plan_(plan), grid_(plan.grid), thickness_(plan.field_thickness), options_(options), sign_(sign) {}

  std::string text() const {
    const std::int64_t side = largest_side();
    const std::string fewer = "at most about " + std::to_string(side) + " samples on the longest side";
    const std::string thinner = "a smaller thickness", higher = "a higher limit";
    if (thinner_helps()) return "take " + (side > 0 ? fewer + ", " + thinner + "," : thinner) + " or " + higher;
    return side > 0 ? "take " + fewer + " or " + higher : "give " + higher;
  }

 private:
  bool fits(const Grid& grid, double thickness) const {
    // A coarser grid gets no larger windows.
    const Size3 window{std::min(grid.size.x, plan_.part.x), std::min(grid.size.y, plan_.part.y),
                       std::min(grid.size.z, plan_.part.z)};
    const Plan plan =
        make_plan(plan_.triangles, grid, thickness, options_, plan_.is_dense, plan_.in_windows ? window : Size3{});
    return bytes_needed(plan, scan_mesh(mesh_, plan, true).counts, sign_) <= memory_limit_of(options_);
  }

  // Tries a band one sample wide.
  bool thinner_helps() const {
    const double thin = grid_.max_spacing();
    return thin < thickness_ && fits(grid_, thin);
  }

  // Samples on the longest side of a coarser grid of the same extent that fits, or 0. It assumes that the thickness is
  // a number of samples, and so grows with the spacing; if the thickness stays, the field is smaller still.
  std::int64_t largest_side() const {
    const std::int64_t longest = std::max({grid_.size.x, grid_.size.y, grid_.size.z});
    std::int64_t fitting = 0, too_many = longest;
    while (too_many - fitting > 1 + fitting / 32) {
      const std::int64_t side = fitting + (too_many - fitting) / 2;
      (fits_with(side, longest) ? fitting : too_many) = side;
    }
    return fitting;
  }
  bool fits_with(std::int64_t side, std::int64_t longest) const {
    const double share = static_cast<double>(side) / static_cast<double>(longest);
    Grid coarse = grid_;
    for (std::int64_t* samples : {&coarse.size.x, &coarse.size.y, &coarse.size.z})
      *samples = std::max<std::int64_t>(1, std::llround(share * static_cast<double>(*samples)));
    coarse.spacing = grid_.spacing / Vec3{share, share, share};
    return fits(coarse, thickness_ / share);
  }

  MeshView mesh_;
  const Plan& plan_;
  const Grid& grid_;
  double thickness_;
  const ComputeOptions& options_;
  const SignMemory& sign_;
};

}  // namespace

std::int64_t bytes_needed(const Plan& plan, const ReachCounts& counts, const SignMemory& sign) {
  const double samples = static_cast<double>(plan.grid.sample_count());
  const double tiles = std::min(counts.tiles, tiles_at_once(plan));
  const double output = plan.is_dense ? 4.0 * samples * (plan.with_nearest ? 2 : 1)
                                      : field_bytes(tiles, tiles_at_once(plan), plan.with_nearest);
  // The sign is planned before the output is made, or, if the backend has doubts, after the backend has freed its
  // memory. Then the sign of a whole grid is decided; in windows, the backend keeps its memory while signs are decided.
  const std::int64_t of_backend = scratch_bytes(plan, counts.brick_refs),
                     crossings = crossing_bytes(plan, counts.crossings);
  const bool crossings_fit = crossings < crossing_bytes(plan);
  const std::int64_t of_sign =
      plan.with_sign ? sign_bytes(plan, crossings_fit) + crossings + open_sign_bytes(plan, sign) : 0;
  const double scratch =
      static_cast<double>(plan.in_windows ? of_backend + of_sign + MeshParts::bytes(plan.triangles)
                                          : std::max({of_backend, of_sign, plan.sign_by_backend ? sign.planning : 0}));
  const double kept =
      plan.rule.kind == SkipRule::Kind::none ? 0 : static_cast<double>(skip_bytes(plan.triangles, plan.rule));
  const double total =
      std::max(static_cast<double>(sign.planning), output + scratch + kept + static_cast<double>(sign.kept));
  return total < 0x1p62 ? static_cast<std::int64_t>(total) : std::int64_t{1} << 62;
}

std::int64_t bytes_needed(const Plan& plan, const ComputeOptions& options) {
  return bytes_needed(plan, ReachCounts{}, most_sign_memory(plan.triangles, options.sign, plan.threads));
}

std::int64_t bytes_needed(MeshView mesh, const Plan& plan, const ComputeOptions& options) {
  return bytes_needed(plan, scan_mesh(mesh, plan, true).counts, sign_memory_of(mesh, plan, options));
}

std::int64_t crossing_bytes(const Plan& plan, double crossings) {
  const std::int64_t least = RowCrossings::least_bytes(plan.triangles, plan.threads),
                     most = plan.in_windows ? kCrossingBytesInWindows : scratch_bytes(plan) - sign_bytes(plan);
  // If there are more, they come in parts.
  const auto all = static_cast<std::int64_t>(std::min(crossings, 0x1p50));
  return std::min(std::max(least, most), RowCrossings::least_bytes(all, plan.threads));
}

void check_memory(MeshView mesh, const Plan& plan, const ReachCounts& counts, const ComputeOptions& options) {
  const SignMemory sign = sign_memory_of(mesh, plan, options);
  const std::int64_t limit = memory_limit_of(options), needed = bytes_needed(plan, counts, sign);
  if (limit == 0 || needed <= limit) return;
  throw Error(ErrorCode::limit,
              "compute: the field may need " + over_the_limit(static_cast<double>(needed), static_cast<double>(limit)) +
                  "; " + Advice(mesh, plan, options, sign).text(),
              {.bytes_needed = needed, .bytes_limit = limit});
}

std::int64_t memory_limit_of(const ComputeOptions& options) { return memory_limit_of(options.memory_limit); }

namespace {

// Of any mesh of so many triangles, or, if there is one, of this mesh.
MemoryEstimate estimate_of(const MeshView* mesh, std::int64_t triangles, const Grid& grid, double thickness,
                           const ComputeOptions& options, std::int64_t slab_samples) {
  const auto plan_of = [&](bool dense, const Size3& window) {
    return make_plan(triangles, grid, thickness, options, dense, window);
  };
  const Plan whole = plan_of(false, {});
  const ReachCounts counts = mesh ? scan_mesh(*mesh, whole, true).counts : ReachCounts{};
  const double tiles = std::min(counts.tiles, tiles_at_once(whole));
  const SignMemory sign =
      mesh ? sign_memory_of(*mesh, whole, options) : most_sign_memory(triangles, options.sign, whole.threads);
  const auto bytes = [&](const Plan& plan) { return bytes_needed(plan, counts, sign); };
  return {.whole = bytes(whole),
          .dense = bytes(plan_of(true, {})),
          .slabs = bytes(plan_of(false, slab_size(grid, slab_samples))),
          .stored_samples = static_cast<std::int64_t>(std::min(DistanceField::kTileSamples * tiles, 0x1p62))};
}

}  // namespace

MemoryEstimate estimate(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options,
                        std::int64_t slab_samples) try {
  validate(grid);
  validate(thickness, options);
  if (triangles < 1 || static_cast<std::uint64_t>(triangles) > kMaxTriangles)
    throw Error(triangles < 1 ? ErrorCode::usage : ErrorCode::limit,
                "compute: no mesh has " + std::to_string(triangles) + " triangles; ask for 1 to " +
                    std::to_string(kMaxTriangles));
  return estimate_of(nullptr, triangles, grid, thickness, options, slab_samples);
} catch (...) {
  throw_as_error("compute");
}

MemoryEstimate estimate(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options,
                        std::int64_t slab_samples) try {
  validate(grid);
  validate(thickness, options);
  return Threads(options.execution.threads).run([&] {
    return estimate_of(&mesh, static_cast<std::int64_t>(mesh.triangles.size()), grid, thickness, options, slab_samples);
  });
} catch (...) {
  throw_as_error("compute");
}

}  // namespace standoff
