// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include "core/guarded.h"
#include "core/memory.h"
#include "core/progress.h"
#include "files/atomic_folder.h"
#include "io/zarr/metadata.h"
#include "io/zarr/windows.h"
#include "standoff/zarr.h"

namespace standoff {

struct ZarrStore::Contents : zarr::StoreMetadata {
  explicit Contents(zarr::StoreMetadata metadata) : zarr::StoreMetadata(std::move(metadata)) {}
};

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

void ZarrStore::write(Size3 first, const DistanceField& window, const ZarrWriteOptions& options) const try {
  if (options.threads < 0) throw Error(ErrorCode::usage, "zarr: threads must be zero or more; give zero for all");
  ProgressMeter meter(options.progress);
  zarr::write_window(*contents_, first, window, options.threads, meter);
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
