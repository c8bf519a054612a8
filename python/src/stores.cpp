// SPDX-License-Identifier: Apache-2.0
// Zarr stores, which are written and read part by part.
#include <filesystem>
#include <string>

#include "common.h"
#include "options.h"
#include "standoff/zarr.h"
#include "work.h"

namespace standoff::python {
namespace {

ZarrStore create(const std::filesystem::path& path, const GridInput& grid, double thickness,
                 const Provenance& provenance, const Counts& shard, const Counts& chunk, bool nearest, bool overwrite) {
  const ZarrLayout layout{.shard = size_of(shard), .chunk = size_of(chunk), .nearest = nearest};
  return ZarrStore::create(path, grid.grid(), thickness, provenance, layout,
                           overwrite ? Existing::replace : Existing::keep);
}

void write_level(const ZarrStore& store, int level, const Counts& first, const Counts& shape, int threads) {
  run_watched(nb::none(), [&](const ProgressCallback& report) {
    store.write_level(level, size_of(first), size_of(shape), {.threads = threads, .progress = report});
  });
}

void write(const ZarrStore& store, const Counts& first, const DistanceField& window, int threads) {
  run_watched(nb::none(), [&](const ProgressCallback& report) {
    store.write(size_of(first), window, {.threads = threads, .progress = report});
  });
}

DistanceField read(const ZarrStore& store, const Counts& first, const Counts& shape, std::int64_t memory_limit) {
  return watched(nb::none(), [&](const ProgressCallback& report) {
    return store.read(size_of(first), size_of(shape), {.memory_limit = memory_limit, .progress = report});
  });
}

}  // namespace

void add_stores(nb::module_& m) {
  const auto point = [](const Vec3& v) { return std::array{v.x, v.y, v.z}; };
  nb::class_<ZarrStore>(m, "Store")
      .def("write", &write, "first"_a, "window"_a, "threads"_a)
      .def("read", &read, "first"_a, "shape"_a, "memory_limit"_a)
      .def("begin_levels", &ZarrStore::begin_levels, "levels"_a)
      .def("write_level", &write_level, "level"_a, "first"_a, "shape"_a, "threads"_a)
      .def("end_levels", &ZarrStore::end_levels, "levels"_a)
      .def_prop_ro("levels", &ZarrStore::levels)
      .def_prop_ro("path", &ZarrStore::path)
      .def_prop_ro("shape", [](const ZarrStore& s) { return counts_of(s.grid().size); })
      .def_prop_ro("origin", [=](const ZarrStore& s) { return point(s.grid().origin); })
      .def_prop_ro("spacing", [=](const ZarrStore& s) { return point(s.grid().spacing); })
      .def_prop_ro("thickness", &ZarrStore::thickness)
      .def_prop_ro("provenance", &ZarrStore::provenance)
      .def_prop_ro("has_nearest", &ZarrStore::has_nearest)
      .def_prop_ro("shard", [](const ZarrStore& s) { return counts_of(s.shard()); })
      .def_prop_ro("chunk", [](const ZarrStore& s) { return counts_of(s.chunk()); });
  m.def("create_store", &create, "path"_a, "grid"_a, "thickness"_a, "provenance"_a, "shard"_a, "chunk"_a, "nearest"_a,
        "overwrite"_a);
  m.def(
      "open_store",
      [](const std::filesystem::path& path, int level) {
        const ZarrStore store = ZarrStore::open(path);
        return level == 0 ? store : store.level(level);
      },
      "path"_a, "level"_a);
}

}  // namespace standoff::python
