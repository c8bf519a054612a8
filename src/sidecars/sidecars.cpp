// SPDX-License-Identifier: Apache-2.0
// Sidecars: makes data of a field's samples from their nearest triangles, tile by tile.
#include "sidecars/sidecars.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <type_traits>

#include "core/guarded.h"
#include "core/memory.h"
#include "core/progress.h"
#include "core/streamed_copy.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "field/cpu/mesh_memory.h"
#include "sidecars/cpu/kernels.h"
#include "sign/plan.h"
#include "sign/sign_text.h"
#include "simd/dispatch.h"
#include "standoff/error.h"
#include "standoff/sidecars.h"

namespace standoff {
namespace {

bool exists(SidecarKind kind) { return kind <= SidecarKind::gradient; }
int components_of(SidecarKind kind) { return kind == SidecarKind::feature ? 1 : 3; }

void check(const DistanceField& field, std::span<const SidecarKind> kinds, const Execution& execution) {
  validate("sidecars", execution, Runs::on_the_cpu);
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("sidecars: ") + what); };
  if (!field.has_nearest())
    fail("the field has no nearest triangles, from which all else follows; compute it with them");
  for (std::size_t n = 0; n < kinds.size(); ++n) {
    if (!exists(kinds[n])) fail("there is no such kind; take one of enum SidecarKind");
    if (std::ranges::find(kinds.first(n), kinds[n]) != kinds.first(n).end())
      fail("a kind is named twice; name each once");
  }
}

// Makes room for the values of each kind.
void make_room(std::span<const SidecarKind> kinds, std::size_t samples, std::vector<Sidecar>& into) {
  into.resize(kinds.size());
  for (std::size_t n = 0; n < kinds.size(); ++n) {
    Sidecar& one = into[n];
    one.name = name_of(kinds[n]);
    one.components = components_of(kinds[n]);
    const auto make = [&]<class Number>(Number) {
      using Values = std::vector<Number>;
      if (!std::holds_alternative<Values>(one.values)) one.values = Values();
      auto& values = std::get<Values>(one.values);
      const std::size_t count = samples * static_cast<std::size_t>(one.components);
      if (values.capacity() < count) {
        values = Values();
        values.reserve(count);
        advise_huge_pages(values.data(), count * sizeof(Number));
      }
      values.resize(count);
    };
    kinds[n] == SidecarKind::feature ? make(std::uint8_t{}) : make(float{});
  }
}

// The field's sign, as far as gradients depend on it.
struct GradientSign {
  bool has_negative = true;     // if the value is negative, the gradient is opposite to the distance's gradient
  bool has_sign = false;        // on the surface, the gradient points outwards
  std::optional<SignText> how;  // how the sign was decided, if the field's provenance says so
};

GradientSign gradient_sign(const DistanceField& field) {
  const std::string& text = field.provenance().sign;
  GradientSign sign{true, !text.empty(), sign_text_in(text)};
  // A shell's values grow away from the mesh on both sides.
  if (sign.how && sign.how->method == SignMethod::shell) sign.has_negative = sign.has_sign = false;
  return sign;
}

// The sidecars of a tile, before they are copied to their places.
struct Scratch {
  StreamedCopies copies;
  alignas(64) float closest_point[3 * kTileSamples];
  alignas(64) float barycentric[3 * kTileSamples];
  alignas(64) float gradient[3 * kTileSamples];
  alignas(64) std::uint8_t feature[kTileSamples];
};

class Pass {
 public:
  Pass(MeshView mesh, const DistanceField& field, std::span<const SidecarKind> kinds, std::vector<Sidecar>& into,
       Simd simd)
      : field_(field),
        tiles_(field.tile_coordinates()),
        kernels_(dispatch_of<cpu::SidecarKernels>().of(simd, "sidecars")) {
    const double scale = sidecar_scale(field.grid());
    mesh_ = {cpu::memory_of(mesh),
             static_cast<std::uint32_t>(mesh.triangles.size()),
             scale,
             1 / scale,
             true,
             false,
             nullptr,
             false};
    for (std::size_t n = 0; n < kinds.size(); ++n) {
      const auto floats = [&] { return std::get<std::vector<float>>(into[n].values).data(); };
      if (kinds[n] == SidecarKind::closest_point) closest_point_ = floats();
      if (kinds[n] == SidecarKind::barycentric) barycentric_ = floats();
      if (kinds[n] == SidecarKind::gradient) gradient_ = floats();
      if (kinds[n] == SidecarKind::feature) feature_ = std::get<std::vector<std::uint8_t>>(into[n].values).data();
    }
  }

  std::size_t tiles() const { return tiles_.size(); }
  void set_sign(const GradientSign& sign) {
    mesh_.has_negative = sign.has_negative;
    mesh_.has_sign = sign.has_sign;
    mesh_.is_reversed = sign.how && sign.how->invert;
  }
  void set_use(const std::vector<std::int8_t>& use) { mesh_.use = use.empty() ? nullptr : use.data(); }

  /// Returns the number of samples of the tile that are on the surface.
  int fill(std::size_t slot, Scratch& scratch) const {
    cpu::SidecarTile tile;
    const std::size_t first = slot * kTileSamples;
    tile.values = field_.tile_values().data() + first;
    tile.nearest = field_.tile_nearest_values().data() + first;
    place(tiles_[slot], tile);
    // Prefetch them: once the samples are sorted, they are read in no regular order.
    constexpr std::size_t kLine = 16;
    for (std::size_t n = 0; n < kTileSamples && gradient_; n += kLine) __builtin_prefetch(tile.values + n);
    tile.closest_point = cleared(closest_point_, scratch.closest_point);
    tile.barycentric = cleared(barycentric_, scratch.barycentric);
    tile.gradient = cleared(gradient_, scratch.gradient);
    tile.feature = cleared(feature_, scratch.feature);
    const int on_surface = kernels_.fill(mesh_, tile);
    if (on_surface < 0) fail(slot, on_surface);
    put(scratch, slot, tile.closest_point, closest_point_);
    put(scratch, slot, tile.barycentric, barycentric_);
    put(scratch, slot, tile.gradient, gradient_);
    put(scratch, slot, tile.feature, feature_);
    return on_surface;
  }

 private:
  // The memory of a tile for a kind, cleared; null if the kind is not asked for.
  template <class Number, std::size_t kCount>
  static Number* cleared(const Number* wanted, Number (&memory)[kCount]) {
    if (!wanted) return nullptr;
    std::memset(memory, 0, sizeof memory);
    return memory;
  }
  template <class Number>
  static void put(const Scratch& scratch, std::size_t slot, const Number* tile, Number* all) {
    constexpr std::size_t kCount = std::is_same_v<Number, float> ? 3 * kTileSamples : kTileSamples;
    if (tile) scratch.copies.copy(all + slot * kCount, tile, kCount * sizeof(Number));
  }

  [[noreturn]] void fail(std::size_t slot, int why) const {
    constexpr const char* kAdvice = "; give the mesh that the field was computed from";
    if (why == cpu::SidecarKernels::kTooFar)
      throw Error(ErrorCode::limit,
                  "sidecars: a triangle is larger or farther away than 2^100 spacings" + std::string(kAdvice));
    throw Error(ErrorCode::input, "sidecars: a sample of tile " + std::to_string(slot) +
                                      " has a nearest triangle that the mesh does not have, of " +
                                      std::to_string(mesh_.triangles) + kAdvice);
  }

  void place(const std::array<int, 3>& at, cpu::SidecarTile& tile) const {
    constexpr std::int64_t kSide = DistanceField::kTileSide;
    for (std::int64_t n = 0; n < kSide; ++n) {
      const Vec3 position = field_.grid().position(kSide * at[0] + n, kSide * at[1] + n, kSide * at[2] + n);
      tile.x[n] = position.x, tile.y[n] = position.y, tile.z[n] = position.z;
    }
  }

  const DistanceField& field_;
  std::vector<std::array<int, 3>> tiles_;
  const cpu::SidecarKernels& kernels_;
  cpu::SidecarMesh mesh_;
  float *closest_point_ = nullptr, *barycentric_ = nullptr, *gradient_ = nullptr;
  std::uint8_t* feature_ = nullptr;
};

void run(Pass& pass, MeshView mesh, const GradientSign& sign, ProgressMeter& progress) {
  constexpr std::size_t kGrain = 16;
  PerThread<std::vector<std::size_t>> on_surface;
  pass.set_sign(sign);
  progress.stage("sidecars", static_cast<std::int64_t>(pass.tiles()), 0, 1);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pass.tiles(), kGrain), [&](const auto& range) {
    Scratch scratch;
    for (std::size_t slot = range.begin(); slot != range.end(); ++slot)
      if (pass.fill(slot, scratch) > 0) on_surface.local().push_back(slot);
    progress.advance(static_cast<std::int64_t>(range.size()));
  });
  // On the surface the gradient is a normal, whose orientation takes a pass over the whole mesh. Few tiles need it:
  // fill these again.
  std::vector<std::size_t> again;
  on_surface.for_each(
      [&](const std::vector<std::size_t>& some) { again.insert(again.end(), some.begin(), some.end()); });
  if (again.empty() || !sign.has_sign) return;
  const std::vector<std::int8_t> use = sign.how ? orientation_of(mesh, *sign.how) : std::vector<std::int8_t>();
  if (use.empty()) return;
  pass.set_use(use);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, again.size(), kGrain), [&](const auto& range) {
    Scratch scratch;
    for (std::size_t n = range.begin(); n != range.end(); ++n) pass.fill(again[n], scratch);
  });
}

}  // namespace

std::vector<std::int8_t> orientation_of(MeshView mesh, const SignText& sign) {
  if (!sign.oriented) return {};
  ProgressMeter unwatched;
  return plan_sign(mesh, {.method = sign.method, .rule = sign.rule}, unwatched).use;
}

std::string name_of(SidecarKind kind) {
  switch (kind) {
    case SidecarKind::closest_point:
      return "closest_point";
    case SidecarKind::barycentric:
      return "barycentric";
    case SidecarKind::feature:
      return "feature";
    case SidecarKind::gradient:
      return "gradient";
  }
  return "";
}

std::int64_t bytes_per_sample(SidecarKind kind) try {
  if (!exists(kind)) throw Error(ErrorCode::usage, "sidecars: there is no such kind; take one of enum SidecarKind");
  return kind == SidecarKind::feature ? 1 : 3 * sizeof(float);
} catch (...) {
  throw_as_error("sidecars");
}

void sidecars_into(MeshView mesh, const DistanceField& field, std::span<const SidecarKind> kinds,
                   std::vector<Sidecar>& into, const SidecarOptions& options) try {
  const Execution& execution = options.execution;
  check(field, kinds, execution);
  ProgressMeter meter(options.progress);
  Threads(execution.threads).run([&] {
    validate(mesh);
    make_room(kinds, kTileSamples * static_cast<std::size_t>(field.stored_tiles()), into);
    Pass pass(mesh, field, kinds, into, execution.simd);
    run(pass, mesh, gradient_sign(field), meter);
  });
  meter.stage("done", 1, 1, 1);
} catch (...) {
  throw_as_error("sidecars", "ask for fewer sidecars or samples, or provide more memory");
}

std::vector<Sidecar> sidecars(MeshView mesh, const DistanceField& field, std::span<const SidecarKind> kinds,
                              const SidecarOptions& options) {
  std::vector<Sidecar> made;
  sidecars_into(mesh, field, kinds, made, options);
  return made;
}

}  // namespace standoff
