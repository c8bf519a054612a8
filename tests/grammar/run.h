// SPDX-License-Identifier: Apache-2.0
// Makes files, has them read in children that may crash, hang and take memory, and counts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/grammar/file.h"

namespace standoff::grammar {

/// What no file may go past.
struct Bounds {
  double seconds = 5;
  std::size_t times_its_size = 16, and_bytes = std::size_t{256} << 20;
};

struct Tally {
  std::uint64_t files = 0, read = 0, refused = 0;
  std::uint64_t good = 0, compared = 0;  ///< that had to be read; of these read, and found to be what was written
  std::uint64_t crashed = 0, hung = 0, over_memory = 0, wrong = 0;
  double longest_s = 0;             ///< that a file took
  std::size_t most_bytes = 0;       ///< of memory that a file took
  std::vector<std::string> faults;  ///< each with its seed; of wrong answers the first ones

  std::uint64_t bad() const { return crashed + hung + over_memory + wrong; }
};

/// The files of seeds first, first + 1, ... The folder gets the files and what lies beside them, and keeps those that
/// `faults` tells of, as bad/SEED.EXTENSION.
Tally run(const Grammar& grammar, std::uint64_t first, std::uint64_t count, const std::filesystem::path& folder,
          const Bounds& bounds = {});

}  // namespace standoff::grammar
