// SPDX-License-Identifier: Apache-2.0
// Bodies in files: a header, then the arrays as they lie in memory, little endian, and a checksum over all of it.
//
// What is read is not believed: sizes are checked against the file's and against what the mesh and the spacing give,
// the BVH's order against being a permutation, tile numbers against the tiles there are. So a damaged or hostile file
// is an error or a body with wrong bounds, but never an access out of range. The checksum finds damage, not malice.
#include "collision/body/model_file.h"
#include "collision/body/model.h"

#include <algorithm>
#include <cmath>

#include "core/guarded.h"
#include "core/tile_count.h"
#include "files/array_file.h"

namespace standoff {
namespace collision {
namespace {

constexpr std::uint32_t kModelVersion = 2;

struct ModelHeader {
  char magic[8];
  std::uint32_t version;
  std::uint32_t closed;  // 1 if the fields have a sign, else 0
  std::uint64_t vertices, triangles, slots, samples, coarse;
  double spacing;
  std::uint64_t components;
};
static_assert(sizeof(ModelHeader::magic) == kBodyMagic.size());
static_assert(sizeof(ModelHeader) == 72 && sizeof(Vec3) == 24 && sizeof(Triangle) == 12);

constexpr std::uint64_t bytes_of_bits(std::uint64_t bits) { return bits / 8 + (bits % 8 != 0); }

void check_field(const ArrayFileReader& arrays, const FieldBounds& field, const ModelHeader& header) {
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

CollisionModel read_model(const FileView& file, ArrayChecksum checksum) {
  ModelHeader header{};
  ArrayFileReader arrays(file, "body");
  arrays.take_header(header, kBodyMagic, kModelVersion);
  if (header.closed > 1) arrays.fail("header", "it is neither closed nor open");
  const auto data = std::make_shared<ModelData>();
  FieldBounds field;
  arrays.take(data->mesh.vertices, header.vertices);
  arrays.take(data->mesh.triangles, header.triangles);
  arrays.take(data->bvh.order, header.triangles);
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
  for (const std::uint32_t t : data->bvh.order) {
    if (t >= header.triangles || seen[t]) arrays.fail("BVH", "its order names a triangle twice or one there is not");
    seen[t] = true;
  }
  if (data->components.empty() || data->components.size() > header.triangles ||
      std::ranges::any_of(data->components, [&](std::uint32_t t) { return t >= header.triangles; }))
    arrays.fail("components", "there are none, too many, or one without a triangle");
  ProgressMeter nobody;
  fill_levels(data->bvh, data->mesh, data->middle, nobody);
  data->finish(nobody);
  return ModelAccess::model(data);
}

}  // namespace collision

void CollisionModel::save(const std::filesystem::path& path, Existing existing) const try {
  using namespace collision;
  const ModelData& d = *data_;
  ArrayFileWriter file(path, existing);
  ModelHeader header{{},
                     kModelVersion,
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
  file.put_all(d.bvh.order);
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
  throw_as_error("model");
}

CollisionModel CollisionModel::load(const std::filesystem::path& path) try {
  return collision::read_model(FileView(path), ArrayChecksum::checked);
} catch (...) {
  throw_as_error("model");
}

}  // namespace standoff
