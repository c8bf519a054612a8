// SPDX-License-Identifier: Apache-2.0
#include "io/field/samples.h"
#include "io/field/tile_reader.h"

namespace standoff {
namespace {

// store(tile) for every stored tile of a layer along the slowest axis.
template <class Store>
void each_stored_tile(const DistanceField& field, bool along_x, std::int64_t layer, const Store& store) {
  const Size3 tiles = field.tile_count();
  for (std::int64_t tz = along_x ? 0 : layer; tz < (along_x ? tiles.z : layer + 1); ++tz)
    for (std::int64_t ty = 0; ty < tiles.y; ++ty)
      for (std::int64_t tx = along_x ? layer : 0; tx < (along_x ? layer + 1 : tiles.x); ++tx) {
        const std::int32_t slot = field.slots()[static_cast<std::size_t>(tx + tiles.x * (ty + tiles.y * tz))];
        if (slot >= 0) store(Size3{8 * tx, 8 * ty, 8 * tz}, slot);
      }
}

template <class Number>
std::vector<Number> load(const FileView& file, const StoredArray& array, const DistanceField& field) {
  const std::int64_t components = array.components;
  std::vector<Number> values(static_cast<std::size_t>(field.stored_tiles() * DistanceField::kTileSamples * components));
  TileReader<Number> reader(file, array, field.grid().size);
  const std::int64_t layers = array.z_fastest ? field.tile_count().x : field.tile_count().z;
  for (std::int64_t component = 0; component < (array.planar ? components : 1); ++component) {
    if (component > 0) reader.next_component();
    for (std::int64_t layer = 0; layer < layers; ++layer) {
      file.check();
      reader.next_layer();
      each_stored_tile(field, array.z_fastest, layer, [&](Size3 first, std::int64_t slot) {
        reader.read_into(first, values.data() + DistanceField::kTileSamples * components * slot + component,
                         components);
      });
    }
  }
  reader.finish();
  return values;
}

}  // namespace

Sidecar load_sidecar(const FileView& file, const StoredSidecar& stored, const DistanceField& field) {
  Sidecar sidecar{stored.name, stored.array.components, {}};
  if (stored.array.type == NumberType::uint8)
    sidecar.values = load<std::uint8_t>(file, stored.array, field);
  else
    sidecar.values = load<float>(file, stored.array, field);
  return sidecar;
}

}  // namespace standoff
