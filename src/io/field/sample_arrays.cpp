// SPDX-License-Identifier: Apache-2.0
#include "io/field/sample_arrays.h"

#include <bit>
#include <set>

#include "standoff/error.h"

namespace standoff {
namespace {

static_assert(std::endian::native == std::endian::little, "field files are written as the machine holds numbers");

template <class Number>
std::array<std::byte, 4> bytes_of_number(Number number) {
  return std::bit_cast<std::array<std::byte, 4>>(number);
}

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= 100 && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

}  // namespace

SampleArray distance_array(const DistanceField& field) {
  return distance_array(field.thickness(), reinterpret_cast<const std::byte*>(field.tile_values().data()));
}

SampleArray distance_array(double thickness, const std::byte* values) {
  const auto far = static_cast<float>(thickness);
  return {"distance", NumberType::float32, 1, values, bytes_of_number(far), bytes_of_number(-far)};
}

std::vector<SampleArray> arrays_of(const DistanceField& field, std::span<const Sidecar> sidecars) {
  std::vector<SampleArray> arrays{distance_array(field)};
  const auto none = bytes_of_number(kNoTriangle);
  if (field.has_nearest())
    arrays.push_back({"nearest_triangle", NumberType::uint32, 1,
                      reinterpret_cast<const std::byte*>(field.tile_nearest_values().data()), none, none});
  for (const Sidecar& sidecar : sidecars) {
    const bool floats = std::holds_alternative<std::vector<float>>(sidecar.values);
    const std::byte* values =
        std::visit([](const auto& v) { return reinterpret_cast<const std::byte*>(v.data()); }, sidecar.values);
    arrays.push_back(
        {sidecar.name, floats ? NumberType::float32 : NumberType::uint8, sidecar.components, values, {}, {}});
  }
  return arrays;
}

void check_sidecars(const DistanceField& field, std::span<const Sidecar> sidecars) {
  // Names that mean something else in one of the formats.
  std::set<std::string> names{"distance", "nearest_triangle", "origin",  "spacing", "thickness",
                              "method",   "mesh_hash",        "version", "sign"};
  for (const Sidecar& sidecar : sidecars) {
    const auto fail = [&](const std::string& what) {
      throw Error(ErrorCode::usage, "sidecar '" + sidecar.name.substr(0, 40) + "': " + what);
    };
    if (!is_name(sidecar.name)) fail("its name is not made of letters, digits and underscores; give it another one");
    if (!names.insert(sidecar.name).second) fail("its name is taken; give it another one");
    if (sidecar.components < 1 || sidecar.components > kMostComponents)
      fail("it has " + std::to_string(sidecar.components) + " numbers per sample; give 1 to " +
           std::to_string(kMostComponents));
    const auto wanted = static_cast<std::uint64_t>(field.stored_tiles()) * DistanceField::kTileSamples *
                        static_cast<std::uint64_t>(sidecar.components);
    const std::uint64_t found = std::visit([](const auto& v) { return std::uint64_t{v.size()}; }, sidecar.values);
    if (found != wanted)
      fail("it has " + std::to_string(found) + " numbers, where the field's stored tiles need " +
           std::to_string(wanted) + "; give those of this field");
  }
}

std::string unstored_element(const SampleArray& array, const ArrayPart& part, bool inside) {
  const std::array<std::byte, 4>& number = inside ? array.inside : array.outside;
  std::string element;
  for (int n = part.component ? 1 : array.components; n > 0; --n)
    element.append(reinterpret_cast<const char*>(number.data()), array.number_bytes());
  return element;
}

}  // namespace standoff
