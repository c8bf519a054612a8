// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include "core/guarded.h"
#include "core/memory.h"
#include "core/progress.h"
#include "files/atomic_folder.h"
#include "io/zarr/metadata.h"
#include "io/zarr/windows.h"
#include "standoff/error.h"
#include "standoff/zarr.h"

namespace standoff {

struct ZarrStore::Contents : zarr::StoreMetadata {
  explicit Contents(zarr::StoreMetadata metadata) : zarr::StoreMetadata(std::move(metadata)) {}
};

namespace {

void check_threads(const ZarrWriteOptions& options) {
  if (options.threads < 0) throw Error(ErrorCode::usage, "zarr: threads must be zero or more; give zero for all");
}

}  // namespace

ZarrStore ZarrStore::create(const std::filesystem::path& path, const Grid& grid, double thickness,
                            const Provenance& provenance, const ZarrLayout& layout, Existing existing) try {
  zarr::check_writable(grid, thickness, layout);
  zarr::StoreMetadata store = zarr::metadata_of(path, grid, thickness, provenance, layout);
  AtomicFolder folder(path, existing, zarr::is_own_store, zarr::kOwnStore);
  zarr::write_metadata(store, folder.path(), path);
  folder.commit();
  return ZarrStore(std::make_shared<const Contents>(std::move(store)));
} catch (...) {
  throw_as_error("zarr");
}

ZarrStore ZarrStore::open(const std::filesystem::path& path) try {
  return ZarrStore(std::make_shared<const Contents>(zarr::read_store(path)));
} catch (...) {
  throw_as_error("zarr");
}

const std::filesystem::path& ZarrStore::path() const { return contents_->path; }
const Grid& ZarrStore::grid() const { return contents_->grid; }
double ZarrStore::thickness() const { return contents_->thickness; }
const Provenance& ZarrStore::provenance() const { return contents_->provenance; }
bool ZarrStore::has_nearest() const { return contents_->nearest.has_value(); }
Size3 ZarrStore::shard() const { return contents_->distance.shard; }
Size3 ZarrStore::chunk() const { return contents_->distance.chunk; }

int ZarrStore::levels() const { return contents_->levels; }

ZarrStore ZarrStore::level(int number) const try {
  return ZarrStore(std::make_shared<const Contents>(zarr::read_store(path(), number)));
} catch (...) {
  throw_as_error("zarr");
}

ZarrStore ZarrStore::write_levels(int levels, const ZarrWriteOptions& options) const try {
  begin_levels(levels);
  for (int number = 1; number < levels; ++number)
    write_level(number, {}, zarr::level_of(*contents_, number).grid.size, options);
  end_levels(levels);
  return level(0);
} catch (...) {
  throw_as_error("zarr");
}

void ZarrStore::begin_levels(int levels) const try {
  zarr::check_levels(*contents_, levels);
  zarr::begin_levels(*contents_, levels);
} catch (...) {
  throw_as_error("zarr");
}

void ZarrStore::write_level(int number, Size3 first, Size3 size, const ZarrWriteOptions& options) const try {
  check_threads(options);
  zarr::check_levels(*contents_, number + 1);
  if (number < 1) throw Error(ErrorCode::usage, "zarr: level 0 is written by write(); give 1 or more");
  const zarr::StoreMetadata level = zarr::level_of(*contents_, number);
  zarr::check_shards(level, first, size);
  ProgressMeter meter(options.progress);
  zarr::write_level(*contents_, number, {first, zarr::plus(first, size)}, true, options.threads, meter);
  meter.stage("done", 1, 1, 1);
} catch (...) {
  throw_as_error("zarr");
}

void ZarrStore::end_levels(int levels) const try {
  zarr::check_levels(*contents_, levels);
  zarr::end_levels(*contents_, levels);
} catch (...) {
  throw_as_error("zarr");
}

void ZarrStore::write(Size3 first, const DistanceField& window, const ZarrWriteOptions& options) const try {
  check_threads(options);
  ProgressMeter meter(options.progress);
  zarr::check_window(*contents_, first, window);
  // Levels, which others may have written since, would no longer be those of the field: it has none until they are
  // written again.
  if (contents_->own && contents_->distance.folder == path() / zarr::kDistanceName &&
      zarr::read_store(path()).levels > 1)
    zarr::end_levels(*contents_, 1);
  zarr::write_window(*contents_, first, window, true, options.threads, meter);
  meter.stage("done", 1, 1, 1);
} catch (...) {
  throw_as_error("zarr");
}

DistanceField ZarrStore::read(Size3 first, Size3 size, const FieldReadOptions& options) const try {
  ProgressMeter meter(options.progress);
  DistanceField field = zarr::read_window(*contents_, first, size, memory_limit_of(options.memory_limit), meter);
  meter.stage("done", 1, 1, 1);
  return field;
} catch (...) {
  throw_as_error("zarr");
}

DistanceField ZarrStore::read(const FieldReadOptions& options) const { return read({}, grid().size, options); }

}  // namespace standoff
