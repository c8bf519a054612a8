// SPDX-License-Identifier: Apache-2.0
// Distance fields: computing, reading and writing them, their arrays, and values between samples.
#include "standoff/field.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <string>

#include "arrays.h"
#include "computed.h"
#include "lock.h"
#include "options.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "standoff/field_cache.h"
#include "standoff/io.h"
#include "standoff/slice.h"
#include "work.h"

namespace standoff::python {
namespace {

using DenseOutput = nb::ndarray<float, nb::shape<-1, -1, -1>, nb::f_contig, nb::device::cpu>;

nb::tuple compute_field(const VertexInput& vertices, const FaceInput& faces, const GridInput& grid, double thickness,
                        const nb::handle& sign, const std::string& method, bool nearest, int threads,
                        const std::string& device, std::int64_t memory_limit, const std::string& up,
                        const nb::object& progress) {
  const MeshView mesh = view_of(vertices, faces);
  ComputeOptions options = compute_options(sign, method, nearest, threads, device, memory_limit);
  options.up = up_of(up);
  double seconds = 0;
  ComputeResult result = watched(progress, [&](const ProgressCallback& report) {
    options.progress = report;
    const Timed timed(seconds);
    return compute(mesh, grid.grid(), thickness, options);
  });
  return nb::make_tuple(std::move(result.field), computation_dict(result.report, seconds));
}

// The computation's dictionary has what became of the cache, too.
nb::tuple compute_cached(const VertexInput& vertices, const FaceInput& faces, const GridInput& grid, double thickness,
                         const nb::handle& sign, const std::string& method, int threads, const std::string& device,
                         std::int64_t memory_limit, const std::string& up, const std::filesystem::path& folder,
                         const nb::object& progress) {
  const MeshView mesh = view_of(vertices, faces);
  ComputeOptions options = compute_options(sign, method, false, threads, device, memory_limit);
  options.up = up_of(up);
  double seconds = 0;
  FieldCache::Computed made = watched(progress, [&](const ProgressCallback& report) {
    options.progress = report;
    const Timed timed(seconds);
    return FieldCache(folder).compute(mesh, grid.grid(), thickness, options);
  });
  nb::dict done = computation_dict(made.report, seconds);
  done["cached"] = made.cached;
  done["problem"] = made.problem;
  return nb::make_tuple(std::move(made.field), done);
}

nb::dict compute_dense(const VertexInput& vertices, const FaceInput& faces, const GridInput& grid, double thickness,
                       const DenseOutput& out, const nb::handle& sign, const std::string& method, int threads,
                       const std::string& device, std::int64_t memory_limit, const nb::object& progress) {
  const MeshView mesh = view_of(vertices, faces);
  ComputeOptions options = compute_options(sign, method, false, threads, device, memory_limit);
  const std::span<float> values(out.data(), out.size());
  double seconds = 0;
  const ComputeReport done = watched(progress, [&](const ProgressCallback& report) {
    options.progress = report;
    const Timed timed(seconds);
    return compute_into(mesh, grid.grid(), thickness, values, options);
  });
  return computation_dict(done, seconds);
}

std::int64_t dense_bytes(const VertexInput& vertices, const FaceInput& faces, const GridInput& grid, double thickness,
                         const nb::handle& sign) {
  return estimate(view_of(vertices, faces), grid.grid(), thickness, compute_options(sign, "tiles", false, 0, "auto", 0))
      .dense;
}

Counts shape_of(const DistanceField& field) { return counts_of(field.grid().size); }

void copy_dense(const DistanceField& field, const DenseOutput& out) {
  const Unlocked released;
  field.copy_slices(0, field.grid().size.z, {out.data(), out.size()});
}

Array<std::uint32_t> nearest_of(const DistanceField& field) {
  const Size3 size = field.grid().size;
  NewArray<std::uint32_t> out(
      {static_cast<std::size_t>(size.z), static_cast<std::size_t>(size.y), static_cast<std::size_t>(size.x)});
  field.copy_nearest_slices(0, size.z, {out.data(), out.count()});
  return out.finish();
}

// The stored tiles [n, i, j, k], as they lie in the field's memory: x fastest. The array keeps the field.
nb::ndarray<nb::numpy, nb::ro, const float> tile_values(const nb::handle& self) {
  const auto& field = nb::cast<const DistanceField&>(self);
  const auto tiles = static_cast<std::size_t>(field.stored_tiles());
  const std::size_t shape[4] = {tiles, 8, 8, 8};
  const std::int64_t strides[4] = {DistanceField::kTileSamples, 1, 8, 64};
  return {field.tile_values().data(), 4, shape, self, strides};
}

nb::ndarray<nb::numpy, nb::ro, const std::int32_t> slots_of(const nb::handle& self) {
  const auto& field = nb::cast<const DistanceField&>(self);
  const std::size_t shape[1] = {field.slots().size()};
  return {field.slots().data(), 1, shape, self};
}

// The field of stored tiles: values as tile_values gives them, (n, 512) in the memory's order, and one entry of slots
// for each tile of the grid.
DistanceField from_tiles(
    const GridInput& grid, double thickness,
    const nb::ndarray<nb::ro, const float, nb::shape<-1, 512>, nb::c_contig, nb::device::cpu>& values,
    const nb::ndarray<nb::ro, const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>& slots,
    const Provenance& provenance) {
  DistanceField field(grid.grid(), thickness);
  const Size3 count = field.tile_count();
  if (slots.shape(0) != static_cast<std::size_t>(count.count()))
    throw nb::value_error("slots: must have one entry for each tile of the grid");
  std::size_t n = 0;
  for (std::int64_t z = 0; z < count.z; ++z)
    for (std::int64_t y = 0; y < count.y; ++y)
      for (std::int64_t x = 0; x < count.x; ++x, ++n) {
        const std::int32_t slot = slots.data()[n];
        if (slot == DistanceField::kInside) field.mark_inside(x, y, z);
        if (slot < 0) continue;
        if (static_cast<std::size_t>(slot) >= values.shape(0))
          throw nb::value_error("slots: names a tile that is not there");
        const float* const from = values.data() + static_cast<std::size_t>(slot) * DistanceField::kTileSamples;
        std::copy_n(from, DistanceField::kTileSamples, field.store_tile(x, y, z).data());
      }
  field.set_provenance(provenance);
  return field;
}

DistanceField from_dense(
    const GridInput& grid, double thickness,
    const nb::ndarray<nb::ro, const float, nb::shape<-1, -1, -1>, nb::f_contig, nb::device::cpu>& values,
    const Provenance& provenance) {
  const Unlocked released;
  DistanceField field = DistanceField::from_dense(grid.grid(), thickness, {values.data(), values.size()});
  field.set_provenance(provenance);
  return field;
}

// Answers at points, from the first to the last of a part: few at once, many so that Ctrl-C stops them. Errors: usage
// (the first point that is not a number: looked for beforehand, because a part does not know where it begins).
void answer_at(std::span<const Vec3> points, const std::function<void(std::size_t, std::size_t)>& part) {
  const auto is_number = [](const Vec3& p) { return !std::isnan(p.x) && !std::isnan(p.y) && !std::isnan(p.z); };
  const auto bad = std::find_if_not(points.begin(), points.end(), is_number);
  if (bad != points.end())
    throw Error(ErrorCode::usage,
                "points: point " + std::to_string(bad - points.begin()) + " is not a number; leave it out");
  constexpr std::size_t kFew = 100'000;  // they take a few milliseconds
  if (points.size() > kFew) return run_in_parts(nb::none(), points.size(), kFew, part);
  const Unlocked released;
  part(0, points.size());
}

Outside outside_of(const std::string& name) {
  constexpr const char* kNames[] = {"nan", "border", "bound"};
  return static_cast<Outside>(choice_of("outside", name, kNames));
}

Array<double> values_at(const DistanceField& field, const PointInput& points, const std::string& outside, int threads) {
  const Outside choice = outside_of(outside);
  NewArray<double> out({points.shape(0)});
  const std::span<const Vec3> all = points_of(points);
  const std::span<double> values(out.data(), out.count());
  answer_at(all, [&](std::size_t first, std::size_t last) {
    field.interpolate(all.subspan(first, last - first), values.subspan(first, last - first), {.threads = threads},
                      choice);
  });
  return out.finish();
}

Array<double> gradients_at(const DistanceField& field, const PointInput& points, const std::string& outside,
                           int threads) {
  const Outside choice = outside_of(outside);
  NewArray<double> out({points.shape(0), 3});
  const std::span<const Vec3> all = points_of(points);
  const std::span<Vec3> gradients(reinterpret_cast<Vec3*>(out.data()), points.shape(0));
  answer_at(all, [&](std::size_t first, std::size_t last) {
    field.gradient(all.subspan(first, last - first), gradients.subspan(first, last - first), {.threads = threads},
                   choice);
  });
  return out.finish();
}

void write(const DistanceField& field, const std::filesystem::path& path, bool compress, bool overwrite, int threads) {
  run_watched(nb::none(), [&](const ProgressCallback& progress) {
    write_field(path, field,
                {.existing = overwrite ? Existing::replace : Existing::keep,
                 .compress = compress,
                 .threads = threads,
                 .progress = progress});
  });
}

DistanceField read(const std::filesystem::path& path, std::int64_t memory_limit) {
  return watched(nb::none(), [&](const ProgressCallback& progress) {
    return read_field(path, {.memory_limit = memory_limit, .progress = progress});
  });
}

void add_grids(nb::module_& m) {
  using Point = std::array<double, 3>;
  using Fitted = std::tuple<std::array<std::int64_t, 3>, Point, Point>;
  const auto fitted = [](const Grid& g) {
    return Fitted{
        {g.size.x, g.size.y, g.size.z}, {g.origin.x, g.origin.y, g.origin.z}, {g.spacing.x, g.spacing.y, g.spacing.z}};
  };
  const auto box = [](const Point& a, const Point& b) { return Box{{a[0], a[1], a[2]}, {b[0], b[1], b[2]}}; };
  m.def(
      "fit_resolution",
      [=](Point a, Point b, std::int64_t resolution, const Padding& padding) {
        return fitted(fit_resolution(box(a, b), resolution, padding));
      },
      "low"_a, "high"_a, "resolution"_a, "padding"_a);
  m.def(
      "fit_spacing",
      [=](Point a, Point b, Point spacing, const Padding& padding) {
        return fitted(fit_spacing(box(a, b), {spacing[0], spacing[1], spacing[2]}, padding));
      },
      "low"_a, "high"_a, "spacing"_a, "padding"_a);
  m.def(
      "fit_size",
      [=](Point a, Point b, std::array<std::int64_t, 3> size, const Padding& padding) {
        return fitted(fit_size(box(a, b), {size[0], size[1], size[2]}, padding));
      },
      "low"_a, "high"_a, "size"_a, "padding"_a);
  nb::class_<Padding>(m, "Padding")
      .def(
          "__init__",
          [](Padding* at, double length, double samples, double least_samples, double most_share) {
            new (at) Padding{length, samples, least_samples, most_share};
          },
          "length"_a, "samples"_a, "least_samples"_a, "most_share"_a);
  m.def("padding_for", &padding_for, "thickness"_a);
  m.def("padding_for_samples", &padding_for_samples, "samples"_a);
  m.attr("DEFAULT_RESOLUTION") = kDefaultResolution;
}

}  // namespace

void add_fields(nb::module_& m) {
  nb::class_<GridInput>(m, "Grid").def(
      "__init__",
      [](GridInput* at, std::array<std::int64_t, 3> size, std::array<double, 3> origin, std::array<double, 3> spacing,
         std::array<std::int64_t, 3> first) {
        new (at) GridInput{size, origin, spacing, first};
        validate(at->grid());
      },
      "size"_a, "origin"_a, "spacing"_a, "first"_a);
  add_grids(m);
  nb::class_<Provenance>(m, "Provenance")
      .def(
          "__init__",
          [](Provenance* at, std::string method, std::uint64_t mesh_hash, std::string version, std::string sign,
             const std::string& up) {
            new (at) Provenance{std::move(method), mesh_hash, std::move(version), std::move(sign), up_of(up)};
          },
          "method"_a, "mesh_hash"_a, "version"_a, "sign"_a, "up"_a = "")
      .def_ro("method", &Provenance::method)
      .def_ro("mesh_hash", &Provenance::mesh_hash)
      .def_ro("version", &Provenance::version)
      .def_ro("sign", &Provenance::sign)
      .def_prop_ro("up", [](const Provenance& from) { return from.up ? std::string(1, name_of(*from.up)) : ""; });
  nb::class_<DistanceField>(m, "Field")
      .def_prop_ro("shape", &shape_of)
      .def_prop_ro("origin",
                   [](const DistanceField& f) {
                     const Vec3 o = f.grid().origin;
                     return std::array{o.x, o.y, o.z};
                   })
      .def_prop_ro("spacing",
                   [](const DistanceField& f) {
                     const Vec3 s = f.grid().spacing;
                     return std::array{s.x, s.y, s.z};
                   })
      .def_prop_ro("first", [](const DistanceField& f) { return counts_of(f.grid().first); })
      .def_prop_ro("thickness", &DistanceField::thickness)
      .def_prop_ro("provenance", &DistanceField::provenance)
      .def_prop_ro("has_nearest", &DistanceField::has_nearest)
      .def_prop_ro("stored_tiles", &DistanceField::stored_tiles)
      .def_prop_ro("memory_bytes", &DistanceField::memory_bytes)
      .def("copy_dense", &copy_dense, "out"_a.noconvert())
      .def("nearest", &nearest_of)
      .def("tile_values", [](nb::handle_t<DistanceField> self) { return tile_values(self); })
      .def("slots", [](nb::handle_t<DistanceField> self) { return slots_of(self); })
      .def("tile_coordinates", [](const DistanceField& f) { return array_over<std::int32_t>(f.tile_coordinates()); })
      .def("values", &values_at, "points"_a.noconvert(), "outside"_a, "threads"_a)
      .def("gradients", &gradients_at, "points"_a.noconvert(), "outside"_a, "threads"_a)
      .def("save", &write, "path"_a, "compress"_a, "overwrite"_a, "threads"_a);
  m.def("read_field", &read, "path"_a, "memory_limit"_a);
  m.def("from_tiles", &from_tiles, "grid"_a, "thickness"_a, "values"_a.noconvert(), "slots"_a.noconvert(),
        "provenance"_a);
  m.def("from_dense", &from_dense, "grid"_a, "thickness"_a, "values"_a.noconvert(), "provenance"_a);
  m.def("compute", &compute_field, "vertices"_a.noconvert(), "faces"_a.noconvert(), "grid"_a, "thickness"_a, "sign"_a,
        "method"_a, "nearest"_a, "threads"_a, "device"_a, "memory_limit"_a, "up"_a, "progress"_a.none());
  m.def("compute_cached", &compute_cached, "vertices"_a.noconvert(), "faces"_a.noconvert(), "grid"_a, "thickness"_a,
        "sign"_a, "method"_a, "threads"_a, "device"_a, "memory_limit"_a, "up"_a, "cache"_a, "progress"_a.none());
  m.def("compute_dense", &compute_dense, "vertices"_a.noconvert(), "faces"_a.noconvert(), "grid"_a, "thickness"_a,
        "out"_a.noconvert(), "sign"_a, "method"_a, "threads"_a, "device"_a, "memory_limit"_a, "progress"_a.none());
  m.def("dense_bytes", &dense_bytes, "vertices"_a.noconvert(), "faces"_a.noconvert(), "grid"_a, "thickness"_a,
        "sign"_a);
  m.def("default_memory_limit", &default_memory_limit);
}

}  // namespace standoff::python
