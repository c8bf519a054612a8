// SPDX-License-Identifier: Apache-2.0
// A maze of walls on a floor: every cell can be reached from every other one in exactly one way.
#include <array>

#include "scenes/families.h"
#include "scenes/random.h"
#include "scenes/solids.h"

namespace standoff::scenes {
namespace {

constexpr int kColumns = 20, kRows = 19;
constexpr double kCell = 7, kHeight = 9.4, kThickness = 0.8;

// Which walls stand: north of and west of every cell, with one row and column more for the outer walls.
struct Maze {
  std::array<std::array<bool, kColumns + 1>, kRows + 1> north{}, west{};
};

Maze make_maze() {
  Maze maze;
  for (auto& row : maze.north) row.fill(true);
  for (auto& row : maze.west) row.fill(true);
  for (int r = 0; r <= kRows; ++r) maze.north[r][kColumns] = false;
  for (int c = 0; c <= kColumns; ++c) maze.west[kRows][c] = false;
  // A walk that opens a wall to a cell not seen before, and goes back where there is none.
  std::array<std::array<bool, kColumns>, kRows> seen{};
  std::vector<std::array<int, 2>> way{{0, 0}};
  seen[0][0] = true;
  for (std::uint64_t step = 0; !way.empty(); ++step) {
    const auto [r, c] = way.back();
    std::array<std::array<int, 2>, 4> next{};
    int choices = 0;
    for (const auto& [dr, dc] : {std::array{-1, 0}, std::array{1, 0}, std::array{0, -1}, std::array{0, 1}}) {
      const int nr = r + dr, nc = c + dc;
      if (nr >= 0 && nr < kRows && nc >= 0 && nc < kColumns && !seen[nr][nc]) next[choices++] = {nr, nc};
    }
    if (choices == 0) {
      way.pop_back();
      continue;
    }
    const auto [nr, nc] = next[hash(step) % static_cast<std::uint64_t>(choices)];
    if (nr != r) maze.north[std::max(r, nr)][c] = false;
    if (nc != c) maze.west[r][std::max(c, nc)] = false;
    seen[nr][nc] = true;
    way.push_back({nr, nc});
  }
  maze.north[0][0] = false;  // the way in and the way out
  maze.north[kRows][kColumns - 1] = false;
  return maze;
}

}  // namespace

void draw_labyrinth(Builder& b) {
  const Maze maze = make_maze();
  const Frame f;
  constexpr double h = kThickness / 2;
  for (int r = 0; r <= kRows; ++r)
    for (int c = 0; c < kColumns; ++c) {
      int end = c;
      while (end < kColumns && maze.north[r][end]) ++end;
      if (end > c) box(b, f, {c * kCell - h, 0, r * kCell - h}, {end * kCell + h, kHeight, r * kCell + h});
      c = end;
    }
  for (int c = 0; c <= kColumns; ++c)
    for (int r = 0; r < kRows; ++r) {
      int end = r;
      while (end < kRows && maze.west[end][c]) ++end;
      if (end > r) box(b, f, {c * kCell - h, 0, r * kCell - h}, {c * kCell + h, kHeight, end * kCell + h});
      r = end;
    }
  const Builder::Coarser flat(b, 2);
  box(b, f, {-h, -0.35, -h}, {kColumns * kCell + h, 0, kRows * kCell + h});
}

}  // namespace standoff::scenes
