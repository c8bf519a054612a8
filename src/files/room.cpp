// SPDX-License-Identifier: Apache-2.0
#include "files/room.h"

#include <cmath>
#include <string>
#include <system_error>

#include "core/number_text.h"
#include "files/atomic_file.h"
#include "standoff/error.h"

namespace standoff {

std::optional<std::uint64_t> room_for(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::absolute(end_of_links(file), error);
  if (error) return std::nullopt;
  const std::filesystem::file_status there = std::filesystem::status(target, error);
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there) &&
      !std::filesystem::is_directory(there))
    return std::nullopt;
  const std::filesystem::space_info space = std::filesystem::space(target.parent_path(), error);
  // There are file systems of networks and of memory that say 0 and take files.
  if (error || space.available == 0 || space.available == static_cast<std::uintmax_t>(-1)) return std::nullopt;
  return space.available;
}

void expect_room(const std::filesystem::path& file, double bytes, std::optional<std::uint64_t> room) {
  constexpr double kMiB = 1 << 20;
  if (!room || bytes <= static_cast<double>(*room)) return;
  throw Error(ErrorCode::output,
              file.string() + ": cannot write it: it takes " + whole_text(std::ceil(bytes / kMiB)) +
                  " MiB, and its disk has " + whole_text(std::floor(static_cast<double>(*room) / kMiB)) +
                  " MiB free; free some, write to another one, or take fewer samples",
              {.file = file.string()});
}

}  // namespace standoff
