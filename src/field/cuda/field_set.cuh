// SPDX-License-Identifier: Apache-2.0
// What the kernels of thin bands compute: one field, or many of one size at once. The kernels are templates of these
// two, so that their logic stands once, and a single field loses nothing by it.
//
// Many fields are stacked along z: tile z of field n is layer z + n * (layers of a field) of the stack. So tiles are
// numbered through all fields, and one list of work holds the tiles of all.
#pragma once

#include "field/lattice.h"
#include "gpu/mesh.cuh"
#include "gpu/platform.cuh"
#include "gpu/scan.h"
#include "gpu/warp.cuh"
#include "standoff/cuda_batch.h"

namespace standoff::STANDOFF_PLATFORM {

#ifndef __CUDACC__
using cuda::BatchPlace;
using cuda::BatchTask;
#endif

/// The n-th triangle to use.
STANDOFF_DEVICE std::uint32_t used_triangle(const DeviceMesh& mesh, std::int64_t n) {
  return mesh.kept ? mesh.kept[n] : static_cast<std::uint32_t>(n);
}

/// One field: all of it lies among a kernel's parameters, in constant memory. Its lattice is a parameter of its own: in
/// one struct with pointers, nvcc 13 reads it all at the kernel's begin, and gather_band spills a quarter more.
struct OneField {
  static constexpr bool kMany = false;
  using Lattices = Lattice;
  DeviceMesh mesh;
  DeviceOutput output;
  Outcome* outcome;
  std::int64_t tiles_each[3];

  OneField(const Lattice& l, const Task& task)
      : mesh(task.mesh), output(task.output), outcome(task.outcome), tiles_each{l.tiles[0], l.tiles[1], l.tiles[2]} {}

  /// Tells whether all work has stopped.
  STANDOFF_HD Outcome* total() const { return outcome; }
  STANDOFF_HD std::int64_t triangle_count() const { return mesh.used_count(); }
  /// Tiles of the stack along an axis.
  STANDOFF_HD std::int64_t tiles(int axis) const { return tiles_each[axis]; }

  /// The number of the field that has triangle n. In warp_field_of() all lanes take part; it is faster where their
  /// triangles ascend.
  STANDOFF_DEVICE std::int64_t field_of(std::int64_t) const { return 0; }
  STANDOFF_DEVICE std::int64_t warp_field_of(std::int64_t) const { return 0; }
  /// The mesh, the output and the outcome of a field, as members of these names.
  STANDOFF_DEVICE const OneField& field(std::int64_t) const { return *this; }
  STANDOFF_DEVICE const Lattice& lattice(const Lattices& lattices, std::int64_t) const { return lattices; }
  /// The index of triangle n in its field's mesh.
  STANDOFF_DEVICE std::uint32_t triangle(std::int64_t, std::int64_t n) const { return used_triangle(mesh, n); }
  /// Whether the field has samples to compute. Asked in the first pass, which does not change it.
  STANDOFF_DEVICE bool has_place(std::int64_t) const { return true; }
  /// Whether a field has stopped while the others go on.
  STANDOFF_DEVICE bool has_stopped_alone(std::int64_t) const { return false; }
  /// The number in the stack of a tile of a field.
  STANDOFF_DEVICE std::int64_t tile(std::int64_t, std::int64_t x, std::int64_t y, std::int64_t z) const {
    return x + tiles_each[0] * (y + tiles_each[1] * z);
  }
  /// The number of the field that has a layer of the stack.
  STANDOFF_DEVICE std::int64_t field_of_layer(std::int64_t) const { return 0; }
  /// Makes a tile of the stack the tile of a field, and returns the field's number.
  STANDOFF_DEVICE std::int64_t unstack(std::int64_t*) const { return 0; }
};

/// One of many fields.
struct PlacedField {
  Lattice lattice;
  DeviceMesh mesh;
  DeviceOutput output;
  Outcome* outcome;
};

/// Many fields of one size, in device memory.
struct ManyFields {
  static constexpr bool kMany = true;
  struct Lattices {};                  // they lie with the fields
  PlacedField* all;                    // of `count`
  const std::int64_t* first_triangle;  // of each field, and behind the last
  Outcome* outcome;                    // the total
  std::int64_t count, triangles;
  std::int64_t tiles_each[3];

  STANDOFF_HD Outcome* total() const { return outcome; }
  STANDOFF_HD std::int64_t triangle_count() const { return triangles; }
  STANDOFF_HD std::int64_t tiles(int axis) const { return axis == 2 ? tiles_each[2] * count : tiles_each[axis]; }

  /// By bisection. It ends at a field that has triangle n whatever the numbers in between are, as long as the first one
  /// is zero and the last one the number of triangles.
  STANDOFF_DEVICE std::int64_t field_of(std::int64_t n) const {
    std::int64_t low = 0, high = count;
    while (high - low > 1) {
      const std::int64_t middle = (low + high) / 2;
      (first_triangle[middle] <= n ? low : high) = middle;
    }
    return low;
  }
  STANDOFF_DEVICE std::int64_t warp_field_of(std::int64_t n) const {
    const std::int64_t of_first = warp_find(first_triangle, count, __shfl_sync(0xffffffffu, n, 0));
    return first_triangle[of_first] <= n && n < first_triangle[of_first + 1] ? of_first : field_of(n);
  }
  STANDOFF_DEVICE const PlacedField& field(std::int64_t number) const { return all[number]; }
  STANDOFF_DEVICE const Lattice& lattice(const Lattices&, std::int64_t number) const { return all[number].lattice; }
  STANDOFF_DEVICE std::uint32_t triangle(std::int64_t number, std::int64_t n) const {
    return static_cast<std::uint32_t>(n - first_triangle[number]);
  }
  STANDOFF_DEVICE bool has_place(std::int64_t number) const {
    return outcome->stopped == 0 && all[number].lattice.scale > 0;
  }
  STANDOFF_DEVICE bool has_stopped_alone(std::int64_t number) const { return all[number].outcome->stopped != 0; }
  STANDOFF_DEVICE std::int64_t tile(std::int64_t number, std::int64_t x, std::int64_t y, std::int64_t z) const {
    return x + tiles_each[0] * (y + tiles_each[1] * (z + tiles_each[2] * number));
  }
  STANDOFF_DEVICE std::int64_t field_of_layer(std::int64_t layer) const { return layer / tiles_each[2]; }
  STANDOFF_DEVICE std::int64_t unstack(std::int64_t* tile) const {
    const std::int64_t number = field_of_layer(tile[2]);
    tile[2] -= number * tiles_each[2];
    return number;
  }
};

/// The number of tiles of all fields.
template <class Fields>
STANDOFF_HD std::int64_t tile_count_of(const Fields& fields) {
  return fields.tiles(0) * fields.tiles(1) * fields.tiles(2);
}

/// Finds the tile with a number in the stack, as a tile of a field, and returns the field's number.
template <class Fields>
STANDOFF_DEVICE std::int64_t find_tile(const Fields& fields, std::int64_t index, std::int64_t* tile) {
  tile[0] = index % fields.tiles(0);
  tile[1] = index / fields.tiles(0) % fields.tiles(1);
  tile[2] = index / (fields.tiles(0) * fields.tiles(1));
  return fields.unstack(tile);
}

}  // namespace standoff::STANDOFF_PLATFORM
