// SPDX-License-Identifier: Apache-2.0
// The table of the field's kernels for this file's instruction set.
#pragma once

#include "field/cpu/kernels/cull_boxes.inl"
#include "field/cpu/kernels/gather_band.inl"
#include "field/cpu/kernels/gather_cells.inl"
#include "field/cpu/kernels/gather_specks.inl"
#include "field/cpu/kernels/reached_bricks.inl"

namespace standoff::cpu::STANDOFF_TARGET {

constexpr Kernels kTable{.name = STANDOFF_TARGET_NAME,
                         .reached_bricks = reached_bricks,
                         .within = within,
                         .clear = clear,
                         .gather_band = {gather_band<false>, gather_band<true>},
                         .band_tiles = band_tiles,
                         .write_tile = write_tile,
                         .nearest_to_lattice = nearest_to_lattice,
                         .nearest_on_triangles = nearest_on_triangles,
                         .nearest_child = nearest_child,
                         .cull_boxes = cull_boxes,
                         .cull_nodes = cull_nodes,
                         .gather_tile = {gather_tile<false>, gather_tile<true>},
                         .load_specks = load_specks,
                         .gather_specks = {gather_specks<false>, gather_specks<true>},
                         .keep_near = keep_near,
                         .gather_crowded = {gather_crowded<false>, gather_crowded<true>}};

}  // namespace standoff::cpu::STANDOFF_TARGET

const standoff::cpu::Kernels standoff::cpu::Kernels::STANDOFF_TARGET = standoff::cpu::STANDOFF_TARGET::kTable;
