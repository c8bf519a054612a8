// SPDX-License-Identifier: Apache-2.0
// Makes bodies from meshes, and saves and loads them. A file is a header, then the arrays as they lie in memory, little
// endian, and a checksum over all of it.
//
// The reader trusts nothing: it checks sizes against the file and against the mesh and its spacing, the BVH's order for
// being a permutation, and tile numbers against the number of tiles. A damaged or hostile file gives an error or a body
// with wrong bounds, but never an access out of range. The checksum finds damage, not malice.
#include "collision/body/body.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/guarded.h"
#include "core/mesh_copy.h"
#include "core/number_text.h"
#include "core/progress.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "core/weld.h"
#include "files/array_file.h"

namespace standoff {
namespace collision {
namespace {

// Disjoint sets of numbers. The lowest number of a set represents it.
class LowestOfSets {
 public:
  explicit LowestOfSets(std::uint32_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t find(std::uint32_t n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (a > b) std::swap(a, b);
    parent_[b] = a;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// Triangles between two checks for interruption.
constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

}  // namespace

std::vector<std::uint32_t> first_of_components(MeshView mesh, ProgressMeter& progress) {
  std::vector<std::uint32_t> number(mesh.vertices.size());
  const std::uint32_t count =
      weld([&](std::uint32_t v) { return mesh.vertices[v]; }, number, [&] { progress.check(); });
  LowestOfSets sets(count);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kCheckEvery == 0) progress.check();
    const Triangle corners = mesh.triangles[t];
    sets.unite(number[corners[0]], number[corners[1]]);
    sets.unite(number[corners[0]], number[corners[2]]);
  }
  std::vector<bool> seen(count);
  std::vector<std::uint32_t> firsts;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kCheckEvery == 0) progress.check();
    const std::uint32_t component = sets.find(number[mesh.triangles[t][0]]);
    if (seen[component]) continue;
    seen[component] = true;
    firsts.push_back(static_cast<std::uint32_t>(t));
  }
  firsts.shrink_to_fit();  // the body keeps it
  return firsts;
}

void BodyData::prepare(double spacing) {
  validate(mesh);
  if (!(spacing >= 0) || !std::isfinite(spacing))
    throw Error(ErrorCode::usage, "body: the spacing must be positive and finite; give zero to have it chosen");
  box = bounds(mesh);
  middle = box.center();
  const double size = box.longest_side();
  if (!(size <= kMaxBodySize) || (size > 0 && size < kMinBodySize) || !(length(middle) < kMaxPosition))
    throw Error(ErrorCode::input, "body: the mesh is " + number_text(size) + " across; scale it to between " +
                                      number_text(kMinBodySize) + " and " + number_text(kMaxBodySize) +
                                      ", and nearer than " + number_text(kMaxPosition) + " to the origin");
  field.box = {box.min - middle, box.max - middle};
}

void BodyData::finish(ProgressMeter& progress) {
  view = field.view();
  corners.reserve(bvh.order().size());
  for (const std::uint32_t t : bvh.order()) {
    if (corners.size() % kCheckEvery == 0) progress.check();
    corners.push_back({mesh.vertices[mesh.triangles[t][0]], mesh.vertices[mesh.triangles[t][1]],
                       mesh.vertices[mesh.triangles[t][2]]});
    for (const Vec3& v : corners.back()) radius = std::max(radius, length(v - middle));
  }
}

std::int64_t BodyData::memory_bytes() const {
  const auto bytes = [](const auto& array) { return array.size() * sizeof(array[0]); };
  std::size_t sum = bytes(mesh.vertices) + bytes(mesh.triangles) + bytes(field.slots) + bytes(field.samples) +
                    bytes(field.coarse) + bytes(field.inside) + bytes(field.coarse_inside) + bytes(corners) +
                    bytes(components) + bytes(bvh.triangles);
  for (const auto& level : bvh.spheres) sum += bytes(level);
  for (const auto& level : bvh.oriented) sum += bytes(level);
  return static_cast<std::int64_t>(sum) + bvh.tree.bytes();
}

}  // namespace collision

Body::Body(MeshView mesh, const BodyOptions& options) try {
  validate("body", options.execution, Runs::everywhere);
  const auto data = std::make_shared<collision::BodyData>();
  validate(mesh);
  data->mesh = copy_of(mesh);
  data->prepare(options.spacing);
  const double spacing = options.spacing > 0 ? options.spacing : collision::default_spacing(mesh, data->box);
  ProgressMeter progress(options.progress);
  Threads(options.execution.threads).run([&] {
    progress.stage("fields", 2, 0, 0.7);
    data->field = collision::build_field_bounds(mesh, data->middle, spacing, options.execution, progress);
    progress.stage("search tree", 1, 0.7, 0.9);
    data->bvh = collision::build_bvh(mesh, data->middle, progress);
    progress.stage("components", 1, 0.9, 1);
    data->components = collision::first_of_components(mesh, progress);
    data->finish(progress);
  });
  progress.stage("done", 1, 1, 1);
  data_ = data;
} catch (...) {
  throw_as_error("body", "take a larger spacing, or provide more memory");
}

MeshView Body::mesh() const { return data_->mesh; }
Box Body::bounds() const { return data_->box; }
Grid Body::grid() const {
  const double h = data_->field.spacing;
  return {data_->field.size, data_->field.origin + data_->middle, {h, h, h}};
}
double Body::thickness() const { return data_->field.thickness(); }
bool Body::has_inside() const { return data_->field.has_sign(); }

std::int64_t Body::memory_bytes() const { return data_->memory_bytes(); }

namespace collision {
namespace {

constexpr std::uint32_t kBodyVersion = 2;

struct BodyHeader {
  char magic[8];
  std::uint32_t version;
  std::uint32_t closed;  // 1 if the fields have a sign, else 0
  std::uint64_t vertices, triangles, slots, samples, coarse;
  double spacing;
  std::uint64_t components;
};
static_assert(sizeof(BodyHeader::magic) == kBodyMagic.size());
static_assert(sizeof(BodyHeader) == 72 && sizeof(Vec3) == 24 && sizeof(Triangle) == 12);

constexpr std::uint64_t bytes_of_bits(std::uint64_t bits) { return bits / 8 + (bits % 8 != 0); }

void check_field(const ArrayFileReader& arrays, const FieldBounds& field, const BodyHeader& header) {
  const auto fail = [&](const char* what) { arrays.fail("field", what); };
  if (header.slots != static_cast<std::uint64_t>(tile_count(field.size)) ||
      header.coarse != static_cast<std::uint64_t>(field.coarse_size.count()))
    fail("its size is not that of the mesh's grid");
  if (header.samples == 0 || header.samples % DistanceField::kTileSamples != 0) fail("its tiles are not whole");
  const std::uint64_t stored = header.samples / DistanceField::kTileSamples;
  for (const std::int32_t slot : field.slots)
    if (slot < 0 || static_cast<std::uint64_t>(slot) >= stored) fail("a tile's number is out of range");
  for (const float value : field.coarse)
    if (!std::isfinite(value)) fail("a distance is not finite");
}

}  // namespace

Body read_body(const FileView& file, ArrayChecksum checksum) {
  BodyHeader header{};
  ArrayFileReader arrays(file, "body");
  arrays.take_header(header, kBodyMagic, kBodyVersion);
  if (header.closed > 1) arrays.fail("header", "it is neither closed nor open");
  const auto data = std::make_shared<BodyData>();
  FieldBounds field;
  arrays.take(data->mesh.vertices, header.vertices);
  arrays.take(data->mesh.triangles, header.triangles);
  std::vector<std::uint32_t> order;
  arrays.take(order, header.triangles);
  arrays.take(field.slots, header.slots);
  arrays.take(field.samples, header.samples);
  arrays.take(field.coarse, header.coarse);
  arrays.take(data->components, header.components);
  if (header.closed != 0) {
    arrays.take(field.inside, bytes_of_bits(header.samples));
    arrays.take(field.coarse_inside, bytes_of_bits(header.coarse));
  }
  arrays.end(checksum);

  if (!(header.spacing > 0) || !std::isfinite(header.spacing))
    arrays.fail("header", "its field's spacing is not positive and finite");
  try {
    data->prepare(header.spacing);
    data->field = plan_field_bounds(data->field.box, header.spacing);
  } catch (const Error& error) {
    arrays.fail("", std::string(diagnosis(error.what())));
  }
  data->field.slots = std::move(field.slots);
  data->field.samples = std::move(field.samples);
  data->field.coarse = std::move(field.coarse);
  data->field.inside = std::move(field.inside);
  data->field.coarse_inside = std::move(field.coarse_inside);
  check_field(arrays, data->field, header);
  std::vector<bool> seen(header.triangles);
  for (const std::uint32_t t : order) {
    if (t >= header.triangles || seen[t]) arrays.fail("BVH", "its order names a triangle twice or one there is not");
    seen[t] = true;
  }
  if (data->components.empty() || data->components.size() > header.triangles ||
      std::ranges::any_of(data->components, [&](std::uint32_t t) { return t >= header.triangles; }))
    arrays.fail("components", "there are none, too many, or one without a triangle");
  ProgressMeter nobody;
  data->bvh = bvh_in_order(std::move(order), data->mesh, data->middle, nobody);
  data->finish(nobody);
  return BodyAccess::body(data);
}

}  // namespace collision

void Body::save(const std::filesystem::path& path, Existing existing) const try {
  using namespace collision;
  const BodyData& d = *data_;
  ArrayFileWriter file(path, existing);
  BodyHeader header{{},
                    kBodyVersion,
                    d.field.has_sign(),
                    d.mesh.vertices.size(),
                    d.mesh.triangles.size(),
                    d.field.slots.size(),
                    d.field.samples.size(),
                    d.field.coarse.size(),
                    d.field.spacing,
                    d.components.size()};
  kBodyMagic.copy(header.magic, sizeof header.magic);
  file.put(&header, sizeof header);
  file.put_all(d.mesh.vertices);
  file.put_all(d.mesh.triangles);
  file.put_all(d.bvh.order());
  file.put_all(d.field.slots);
  file.put_all(d.field.samples);
  file.put_all(d.field.coarse);
  file.put_all(d.components);
  if (d.field.has_sign()) {
    file.put_all(d.field.inside);
    file.put_all(d.field.coarse_inside);
  }
  file.commit();
} catch (...) {
  throw_as_error("body");
}

Body Body::load(const std::filesystem::path& path) try {
  return collision::read_body(FileView(path), ArrayChecksum::checked);
} catch (...) {
  throw_as_error("body");
}

}  // namespace standoff
