// SPDX-License-Identifier: Apache-2.0
// Bodies in files: a header, then the arrays as they lie in memory, little endian, and a checksum over all of it.
//
// What is read is not believed: sizes are checked against the file's and against what the mesh and the spacing give,
// the BVH's order against being a permutation, tile numbers against the tiles there are. So a damaged or hostile file
// is an error or a body with wrong bounds, but never an access out of range. The checksum finds damage, not malice.
#include "collision/body/model_file.h"
#include "collision/body/model.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/guarded.h"
#include "core/splitmix64.h"
#include "core/tile_count.h"
#include "files/atomic_file.h"
#include "files/body_magic.h"

namespace standoff {
namespace collision {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

constexpr std::uint32_t kVersion = 2;

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t closed;  // 1 if the fields have a sign, else 0
  std::uint64_t vertices, triangles, slots, samples, coarse;
  double spacing;
  std::uint64_t components;
};
static_assert(sizeof(Header::magic) == kBodyMagic.size());
static_assert(sizeof(Header) == 72 && sizeof(Vec3) == 24 && sizeof(Triangle) == 12);

constexpr std::uint64_t bytes_of_bits(std::uint64_t bits) { return bits / 8 + (bits % 8 != 0); }

// Eight bytes at a time. A round is a third of splitmix64, for speed: it can be undone, so no changed word goes unseen.
class Checksum {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* at = static_cast<const unsigned char*>(data);
    for (; bytes >= 8; bytes -= 8, at += 8) {
      std::uint64_t word;
      std::memcpy(&word, at, 8);
      mix(word);
    }
    std::uint64_t word = bytes;
    for (std::size_t n = 0; n < bytes; ++n) word = word << 8 | at[n];
    mix(word);
  }
  std::uint64_t value() const { return hash_; }

 private:
  void mix(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 0xbf58476d1ce4e5b9u;
    hash_ ^= hash_ >> 29;
  }
  std::uint64_t hash_ = kSplitmixStep;
};

// The arrays of a file, one after the other.
class Arrays {
 public:
  Arrays(const FileView& file, std::size_t at) : file_(file), at_(at) {}
  template <class Vector>
  void take(Vector& to, std::uint64_t count, Checksum& sum) {
    using T = typename Vector::value_type;
    // Division, for the product may overflow.
    if (count > (file_.size() - at_) / sizeof(T))
      file_.fail("byte " + std::to_string(at_), "the file ends too early; save the body again");
    to.resize(count);
    if (count > 0) std::memcpy(to.data(), file_.bytes().data() + at_, count * sizeof(T));
    sum.add(to.data(), count * sizeof(T));
    at_ += count * sizeof(T);
  }
  std::size_t at() const { return at_; }

 private:
  const FileView& file_;
  std::size_t at_;
};

void check_field(const FileView& file, const FieldBounds& field, const Header& header) {
  const auto fail = [&](const char* what) { file.fail("field", std::string(what) + "; save the body again"); };
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

CollisionModel read_model(const FileView& file, BodyChecksum checksum) {
  Header header{};
  if (file.size() < sizeof header + sizeof(std::uint64_t) || !file.bytes().starts_with(kBodyMagic))
    file.fail("", "this is no body that standoff saved; give a mesh, or save a body again");
  std::memcpy(&header, file.bytes().data(), sizeof header);
  if (header.version != kVersion)
    file.fail("header", "version " + std::to_string(header.version) + " is not known to this standoff, which knows " +
                            std::to_string(kVersion) + "; save the body again");
  if (header.closed > 1) file.fail("header", "it is neither closed nor open; save the body again");
  Checksum sum;
  sum.add(&header, sizeof header);
  const auto data = std::make_shared<ModelData>();
  Arrays arrays(file, sizeof header);
  FieldBounds field;
  arrays.take(data->mesh.vertices, header.vertices, sum);
  arrays.take(data->mesh.triangles, header.triangles, sum);
  arrays.take(data->bvh.order, header.triangles, sum);
  arrays.take(field.slots, header.slots, sum);
  arrays.take(field.samples, header.samples, sum);
  arrays.take(field.coarse, header.coarse, sum);
  arrays.take(data->components, header.components, sum);
  if (header.closed != 0) {
    arrays.take(field.inside, bytes_of_bits(header.samples), sum);
    arrays.take(field.coarse_inside, bytes_of_bits(header.coarse), sum);
  }
  std::uint64_t stored = 0;
  if (file.size() - arrays.at() != sizeof stored)
    file.fail("", "its length is not what its header says; save the body again");
  std::memcpy(&stored, file.bytes().data() + arrays.at(), sizeof stored);
  if (checksum == BodyChecksum::checked && stored != sum.value())
    file.fail("", "it is damaged: its checksum is not that of its content; save the body again");

  if (!(header.spacing > 0) || !std::isfinite(header.spacing))
    file.fail("header", "its field's spacing is not positive and finite; save the body again");
  try {
    data->prepare(header.spacing);
    data->field = plan_field_bounds(data->field.box, header.spacing);
  } catch (const Error& error) {
    file.fail("", std::string(diagnosis(error.what())) + "; save the body again");
  }
  data->field.slots = std::move(field.slots);
  data->field.samples = std::move(field.samples);
  data->field.coarse = std::move(field.coarse);
  data->field.inside = std::move(field.inside);
  data->field.coarse_inside = std::move(field.coarse_inside);
  check_field(file, data->field, header);
  std::vector<bool> seen(header.triangles);
  for (const std::uint32_t t : data->bvh.order) {
    if (t >= header.triangles || seen[t])
      file.fail("BVH", "its order names a triangle twice or one there is not; save the body again");
    seen[t] = true;
  }
  if (data->components.empty() || data->components.size() > header.triangles ||
      std::ranges::any_of(data->components, [&](std::uint32_t t) { return t >= header.triangles; }))
    file.fail("components", "there are none, too many, or one without a triangle; save the body again");
  fill_levels(data->bvh, data->mesh, data->middle);
  data->finish();
  return ModelAccess::model(data);
}

}  // namespace collision

void CollisionModel::save(const std::filesystem::path& path, Existing existing) const try {
  using namespace collision;
  const ModelData& d = *data_;
  AtomicFile file(path, existing);
  Checksum sum;
  const auto put = [&](const void* data, std::size_t bytes) {
    file.write(data, bytes);
    sum.add(data, bytes);
  };
  const auto put_all = [&](const auto& array) { put(array.data(), array.size() * sizeof(array[0])); };
  Header header{{},
                kVersion,
                d.field.has_sign(),
                d.mesh.vertices.size(),
                d.mesh.triangles.size(),
                d.field.slots.size(),
                d.field.samples.size(),
                d.field.coarse.size(),
                d.field.spacing,
                d.components.size()};
  kBodyMagic.copy(header.magic, sizeof header.magic);
  put(&header, sizeof header);
  put_all(d.mesh.vertices);
  put_all(d.mesh.triangles);
  put_all(d.bvh.order);
  put_all(d.field.slots);
  put_all(d.field.samples);
  put_all(d.field.coarse);
  put_all(d.components);
  if (d.field.has_sign()) {
    put_all(d.field.inside);
    put_all(d.field.coarse_inside);
  }
  const std::uint64_t value = sum.value();
  file.write(&value, sizeof value);
  file.commit();
} catch (...) {
  throw_as_error("model");
}

CollisionModel CollisionModel::load(const std::filesystem::path& path) try {
  return collision::read_model(FileView(path), collision::BodyChecksum::checked);
} catch (...) {
  throw_as_error("model");
}

}  // namespace standoff
