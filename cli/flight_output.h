// SPDX-License-Identifier: Apache-2.0
// What standoff fly records a flight into: a page, pictures in a folder, or a video.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/files.h"
#include "fly/flight_page.h"
#include "standoff/picture.h"
#include "standoff/progress.h"

namespace standoff::cli {

class FlightOutput {
 public:
  /// Adds -o, --every, --rate and the options of pictures; returns -o.
  CLI::Option* add_to(CLI::App& verb);

  bool given() const { return !name_.empty(); }
  const std::filesystem::path& path() const { return file_.path(); }
  std::int64_t every() const { return every_; }
  /// Tells before anything is flown what would go wrong after it. `like` has the same --force. Errors: usage, output.
  void check(const FileOutput& like, const std::vector<std::string>& inputs);
  /// Draws and writes. Errors: as write_frames and write_video; output.
  void write(const fly::FlightSubject& subject, std::span<const fly::FlightFrame> frames, int threads,
             const ProgressCallback& progress) const;
  /// Of all that was written.
  std::int64_t bytes() const;

 private:
  enum class Kind { page, folder, video };

  std::string name_;
  Kind kind_ = Kind::page;
  FileOutput file_;
  std::int64_t every_ = 1;
  double frames_per_second_ = 60;
  PictureOptions picture_{.width = 1280, .height = 720, .elevation_deg = 40, .up = Axis::y};
  std::vector<const CLI::Option*> of_films_, of_pictures_;
};

}  // namespace standoff::cli
