// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/guarded.h"
#include "core/memory.h"
#include "core/progress.h"
#include "files/file_view.h"
#include "io/field/format.h"
#include "io/field/read_samples.h"
#include "standoff/error.h"
#include "standoff/field_slices.h"

namespace standoff {
namespace {

// The format of a file, if its samples can be read from any slice on.
const FieldFormat* sliced_format(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  const FieldFormat* const format = extension.empty() ? nullptr : find_field_format(extension.substr(1));
  return format && format->header ? format : nullptr;
}

bool is_store(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

// Slabs of whole layers of a store's chunks.
class StoredSlabs final : public FieldSlabs {
 public:
  StoredSlabs(FieldSlices slices, FieldReadOptions options, std::int64_t slab_samples)
      : slices_(std::move(slices)), options_(std::move(options)) {
    constexpr std::int64_t kLayer = 32;
    const Size3& size = slices_.grid().size;
    step_ = kLayer * std::max<std::int64_t>(1, slab_samples / (size.x * size.y) / kLayer);
  }
  const Grid& grid() const override { return slices_.grid(); }
  double thickness() const override { return slices_.thickness(); }
  bool has_nearest() const override { return slices_.has_nearest(); }
  const Provenance& provenance() const override { return slices_.provenance(); }
  const DistanceField* next() override {
    const std::int64_t left = grid().size.z - next_;
    if (left <= 0) return nullptr;
    slab_ = DistanceField();  // not two at a time
    slab_ = slices_.read(next_, std::min(step_, left), options_);
    next_ += step_;
    return &slab_;
  }

 private:
  const FieldSlices slices_;
  const FieldReadOptions options_;
  std::int64_t step_ = 0, next_ = 0;
  DistanceField slab_;
};

}  // namespace

struct FieldSlices::Contents {
  std::optional<ZarrStore> store;
  std::optional<FileView> file;  // where it is no store
  StoredField stored;
};

bool FieldSlices::can_open(const std::filesystem::path& path) try {
  return is_store(path) || sliced_format(path);
} catch (...) {
  throw_as_error("field");
}

FieldSlices FieldSlices::open(const std::filesystem::path& path) try {
  if (is_store(path)) return FieldSlices(ZarrStore::open(path));
  const FieldFormat* const format = sliced_format(path);
  if (!format)
    throw Error(ErrorCode::usage, path.string() +
                                      ": of this format no slices are read alone; convert it to .zarr or .vti, or read "
                                      "the whole field");
  auto contents = std::make_shared<Contents>();
  contents->file.emplace(path, FileView::Access::map);
  if (contents->file->size() == 0) contents->file->fail("the file is empty; write it again");
  contents->stored = format->header(*contents->file);
  return FieldSlices(std::move(contents));
} catch (...) {
  throw_as_error("field");
}

FieldSlices::FieldSlices(const ZarrStore& store) {
  auto contents = std::make_shared<Contents>();
  contents->store = store;
  contents->stored.grid = store.grid();
  contents->stored.thickness = store.thickness();
  contents->stored.provenance = store.provenance();
  contents_ = std::move(contents);
}

const Grid& FieldSlices::grid() const { return contents_->stored.grid; }
double FieldSlices::thickness() const { return contents_->stored.thickness; }
const Provenance& FieldSlices::provenance() const { return contents_->stored.provenance; }
bool FieldSlices::has_nearest() const {
  return contents_->store ? contents_->store->has_nearest() : contents_->stored.nearest.has_value();
}
std::vector<std::string> FieldSlices::sidecars() const {
  std::vector<std::string> names;
  for (const StoredSidecar& sidecar : contents_->stored.sidecars) names.push_back(sidecar.name);
  return names;
}

DistanceField FieldSlices::read(std::int64_t first, std::int64_t count, const FieldReadOptions& options) const try {
  const Size3& size = grid().size;
  if (contents_->store) return contents_->store->read({0, 0, first}, {size.x, size.y, count}, options);
  if (first < 0 || count < 1 || first >= size.z || count > size.z - first)
    throw Error(ErrorCode::usage, contents_->file->path().string() + ": " + std::to_string(count) +
                                      " slices from slice " + std::to_string(first) + " on are not within the " +
                                      std::to_string(size.z) + " of the field; ask for a part of it");
  ProgressMeter meter(options.progress);
  meter.stage("reading", 1, 0, 1);
  StoredField part = contents_->stored;
  part.sidecars.clear();
  part.grid = grid().window({0, 0, first}, {size.x, size.y, count});
  const std::uint64_t before =
      sample_bytes(grid()) / static_cast<std::uint64_t>(size.z) * static_cast<std::uint64_t>(first);
  part.distance = part.distance.from(before);
  if (part.nearest) part.nearest = part.nearest->from(before);
  DistanceField field = load_field(*contents_->file, part, {memory_limit_of(options.memory_limit), false}).field;
  meter.stage("done", 1, 1, 1);
  return field;
} catch (...) {
  throw_as_error("field");
}

SliceReader FieldSlices::reader(const FieldReadOptions& options) const {
  return
      [slices = *this, options](std::int64_t first, std::int64_t count) { return slices.read(first, count, options); };
}

std::unique_ptr<FieldSlabs> FieldSlices::slabs(const FieldReadOptions& options, std::int64_t slab_samples) const try {
  if (slab_samples < 1) throw Error(ErrorCode::usage, "slabs without samples; give 1 or more");
  return std::make_unique<StoredSlabs>(*this, options, slab_samples);
} catch (...) {
  throw_as_error("field");
}

}  // namespace standoff
