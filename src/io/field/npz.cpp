// SPDX-License-Identifier: Apache-2.0
// NPZ: a zip archive of NumPy arrays, one file each.
#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "files/deflate.h"
#include "files/file_view.h"
#include "files/zip.h"
#include "io/field/format.h"
#include "io/field/npy.h"
#include "io/field/read_samples.h"
#include "io/field/write_samples.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr const char* kDistance = "distance";
constexpr const char* kNearestName = "nearest_triangle";

std::string quoted(const std::string& name) { return "'" + name + "'"; }

// An array of the archive.
struct Member : NpyArray {
  const ZipMember* zip = nullptr;
  std::string name;   // for messages
  std::string start;  // its file's first bytes: all that small arrays have

  // Value n of an array that lies in the first bytes.
  template <class Number>
  Number value(std::uint64_t n) const {
    Number number;
    std::memcpy(&number, start.data() + offset + n * sizeof number, sizeof number);
    return number;
  }
};

class Archive {
 public:
  explicit Archive(const FileView& file) : file_(file), members_(read_zip(file)) {}

  // The array of that name.
  std::optional<Member> find(const std::string& name) const {
    for (const ZipMember& zip : members_)
      if (zip.name == name + ".npy") return open(zip);
    return std::nullopt;
  }
  Member get(const std::string& name) const {
    if (auto array = find(name)) return *std::move(array);
    file_.fail("the array " + quoted(name) + " is missing; save it too");
  }

  // A single number, or one per axis.
  std::vector<double> numbers(const Member& array, std::size_t count) const {
    std::uint64_t values = 1;
    for (const auto side : array.shape)
      values = side == 1 ? values : values == 1 ? static_cast<std::uint64_t>(side) : 0;
    const std::uint64_t width = array.type == "<f8" || array.type == "<i8" ? 8 : array.type == "<f4" ? 4 : 0;
    if (values != count || width == 0 || !is_small(array, count * width))
      file_.fail(array.name,
                 "it is not " + std::to_string(count) + " number(s) of type float64; save it again as such");
    std::vector<double> numbers;
    for (std::uint64_t n = 0; n < count; ++n)
      numbers.push_back(array.type == "<f8"   ? array.value<double>(n)
                        : array.type == "<i8" ? static_cast<double>(array.value<std::int64_t>(n))
                                              : static_cast<double>(array.value<float>(n)));
    return numbers;
  }
  Vec3 vector(const std::string& name) const {
    const auto v = numbers(get(name), 3);
    return {v[0], v[1], v[2]};
  }

  // A string: numpy keeps 4 bytes per character. Those beyond ASCII read as '?'.
  std::string text(const std::string& name) const {
    const auto array = find(name);
    if (!array) return {};
    const auto length = array->type.starts_with("<U")
                            ? number_in<std::uint64_t>(std::string_view(array->type).substr(2))
                            : std::nullopt;
    if (!length || *length > kMaxText || !array->shape.empty() || !is_small(*array, 4 * *length))
      file_.fail(array->name, "it is not a short string; save it again as one");
    std::string text;
    for (std::uint64_t n = 0; n < *length; ++n) {
      const auto c = array->value<std::uint32_t>(n);
      if (c != 0) text += c < 128 ? static_cast<char>(c) : '?';
    }
    return text;
  }

  std::uint64_t hash(const std::string& name) const {
    const auto array = find(name);
    return array && array->type == "<u8" && is_small(*array, 8) ? array->value<std::uint64_t>(0) : 0;
  }

  // Returns the other arrays that hold one or a few numbers for each sample. Arrays of other shapes are passed over.
  std::vector<StoredSidecar> sidecars(const Size3& size) const {
    std::vector<StoredSidecar> found;
    std::set<std::string> names = reserved_names();
    for (const ZipMember& zip : members_) {
      const std::string name = zip.name.substr(0, zip.name.size() - std::min<std::size_t>(zip.name.size(), 4));
      if (zip.name != name + ".npy" || !names.insert(name).second) continue;
      try {
        if (const auto array = sidecar(open(zip), size)) found.push_back({name, *array});
      } catch (const Error&) {
      }
    }
    return found;
  }

  // Three-dimensional samples of the given kind: "f4" or "u4". The archive must outlive them.
  StoredArray samples(const Member& array, const std::string& kind, Size3& size) const {
    if (array.type != "<" + kind && array.type != ">" + kind)
      file_.fail(array.name, "its type is " + in_quotes(array.type) + "; save it as " + quoted("<" + kind));
    if (array.shape.size() != 3) file_.fail(array.name, "it has not three axes; save it as array[i,j,k]");
    std::uint64_t room = array.bytes / 4;
    for (const auto side : array.shape) room = side > 0 ? room / static_cast<std::uint64_t>(side) : 0;
    if (room == 0) file_.fail(array.name, "it is shorter than its shape says; the file is damaged, write it again");
    size = {array.shape[0], array.shape[1], array.shape[2]};
    return stored(array, NumberType::float32, 1);
  }

 private:
  Member open(const ZipMember& zip) const {
    Member member;
    member.zip = &zip;
    member.name = zip.name;
    member.start = ZipMemberStream(file_, zip).next(std::min(zip.bytes, kStart));
    static_cast<NpyArray&>(member) = read_npy(file_, member.name, member.start, zip.bytes);
    return member;
  }

  StoredArray stored(const Member& array, NumberType type, int components) const {
    const auto open = [this, zip = array.zip] { return std::make_unique<ZipMemberStream>(file_, *zip); };
    return {.offset = array.offset,
            .big_endian = array.type.starts_with('>'),
            .z_fastest = !array.fortran_order,
            .open = open,
            .packed = array.zip->deflated,
            .type = type,
            .components = components,
            .planar = array.fortran_order};
  }

  std::optional<StoredArray> sidecar(const Member& array, const Size3& size) const {
    const bool floats = array.type == "<f4" || array.type == ">f4";
    const auto& shape = array.shape;
    const std::int64_t components = shape.size() == 4 ? shape[3] : 1;
    if ((!floats && array.type != "|u1") || (shape.size() != 3 && shape.size() != 4)) return std::nullopt;
    if (Size3{shape[0], shape[1], shape[2]} != size || components < 1 || components > kMostComponents)
      return std::nullopt;
    const std::uint64_t needed = sample_bytes({size, {}}) / (floats ? 1 : 4) * static_cast<std::uint64_t>(components);
    if (array.bytes < needed) return std::nullopt;
    return stored(array, floats ? NumberType::float32 : NumberType::uint8, static_cast<int>(components));
  }

  // All of a small array's file; its checksum has been compared when it was read.
  static constexpr std::uint64_t kStart = kMaxNpyHeader + 4 * kMaxText;

  // Whether the array has the bytes, and its file is no longer than small ones are.
  static bool is_small(const Member& array, std::uint64_t bytes) {
    return array.bytes >= bytes && array.zip->bytes <= kStart;
  }

  const FileView& file_;
  std::vector<ZipMember> members_;
};

class ArrayWriter : public NpzArrays {
 public:
  using NpzArrays::NpzArrays;

  void text(const std::string& name, const std::string& value) {
    std::vector<std::uint32_t> characters;
    for (const unsigned char c : value) characters.push_back(c < 128 ? c : '?');
    // numpy has no empty strings: one zero character reads as "".
    if (characters.empty()) characters.push_back(0);
    small(name, {"<U" + std::to_string(characters.size()), {}, false}, std::as_bytes(std::span(characters)));
  }
  // Numbers of a sample are the array's last axis: one component follows the other.
  void samples(const FieldSource& field, const SampleArray& array, const FieldWriteOptions& options) {
    const Size3& size = field.grid().size;
    std::vector<std::int64_t> shape{size.x, size.y, size.z};
    if (array.components > 1) shape.push_back(array.components);
    const char* const type = array.type == NumberType::uint8 ? "|u1" : array.type == NumberType::uint32 ? "<u4" : "<f4";
    const NpyHeader header{type, shape, true};
    const std::uint64_t bytes = static_cast<std::uint64_t>(size.count()) * array.element_bytes();
    std::uint32_t crc = options.compress ? begin_deflated(array.name, header, bytes) : 0;
    if (!options.compress) begin(array.name, header, bytes);
    for (int component = 0; component < array.components; ++component) {
      if (!options.compress) {
        send_samples(field, array, {component}, [&](std::span<const std::byte> part) { zip_.write(part); });
        continue;
      }
      pack_samples(field, array, {component}, {BlockKind::deflate, options.threads, crc},
                   [&](const PackedBlock& block) {
                     zip_.write_deflated(block.bytes);
                     crc = block.crc;
                   });
    }
    if (!options.compress) return zip_.end();
    zip_.write_deflated(kDeflateEnd);
    zip_.end_deflated(crc);
  }

 private:
  // Returns the checksum of the header.
  std::uint32_t begin_deflated(const std::string& name, const NpyHeader& header, std::uint64_t bytes) {
    const std::string text = npy_header(header);
    zip_.begin_deflated(name + ".npy", text.size() + bytes);
    RunDeflater deflater(1);
    deflater.elements(reinterpret_cast<const std::byte*>(text.data()), text.size());
    std::string deflated;
    deflater.deflate(deflated, RunDeflater::End::more);
    zip_.write_deflated(deflated);
    return crc32_of(0, std::as_bytes(std::span(text)));
  }
};

FieldFile read_npz(const FileView& file, const FieldRequest& request) {
  const Archive archive(file);
  StoredField stored;
  stored.distance = archive.samples(archive.get(kDistance), "f4", stored.grid.size);
  stored.grid.origin = archive.vector("origin");
  stored.grid.spacing = archive.vector("spacing");
  if (const auto thickness = archive.find("thickness")) stored.thickness = archive.numbers(*thickness, 1)[0];
  stored.provenance.method = archive.text("method");
  stored.provenance.version = archive.text("version");
  stored.provenance.mesh_hash = archive.hash("mesh_hash");
  if (archive.find("sign")) stored.provenance.sign = archive.text("sign");
  if (archive.find("up")) stored.provenance.up = axis_in(archive.text("up"));
  if (const auto nearest = archive.find(kNearestName)) {
    Size3 size;
    stored.nearest = archive.samples(*nearest, "u4", size);
    if (size != stored.grid.size || stored.nearest->z_fastest != stored.distance.z_fastest)
      file.fail(nearest->name, "its shape or order is not that of " + quoted(kDistance) + "; save both alike");
  }
  if (request.sidecars) stored.sidecars = archive.sidecars(stored.grid.size);
  return load_field(file, stored, request);
}

void write_npz(AtomicFile& file, const FieldSource& field, const FieldWriteOptions& options) {
  const Grid& grid = field.grid();
  ArrayWriter arrays(file);
  arrays.vector("origin", grid.corner());
  arrays.vector("spacing", grid.spacing);
  const double thickness = field.thickness();
  arrays.small("thickness", {"<f8", {}, false}, std::as_bytes(std::span(&thickness, 1)));
  arrays.text("method", field.provenance().method);
  const std::uint64_t hash = field.provenance().mesh_hash;
  arrays.small("mesh_hash", {"<u8", {}, false}, std::as_bytes(std::span(&hash, 1)));
  arrays.text("version", field.provenance().version);
  if (!field.provenance().sign.empty()) arrays.text("sign", field.provenance().sign);
  if (field.provenance().up) arrays.text("up", axis_text(field.provenance().up));
  for (const SampleArray& array : field.arrays()) arrays.samples(field, array, options);
  arrays.finish();
}

}  // namespace

constinit const FieldFormat kFieldNpz{.extension = "npz",
                                      .description = "NumPy arrays",
                                      .nearest = true,
                                      .sidecars = true,
                                      .slabs = true,
                                      .read = read_npz,
                                      .write = write_npz};

}  // namespace standoff
