// SPDX-License-Identifier: Apache-2.0
// A recorded flight as pictures in a folder, or as a video (docs/fly.md).
#pragma once

#include <filesystem>
#include <span>

#include "fly/flight_page.h"
#include "standoff/existing.h"
#include "standoff/picture.h"
#include "standoff/progress.h"

namespace standoff::fly {

/// What is filmed, and how. Shadows and axes are not drawn.
struct Film {
  const FlightSubject& subject;
  std::span<const FlightFrame> frames;
  double frames_per_second = 60;
  PictureOptions picture;
};

/// Throws Error{usage}, before anything is flown, where the folder is not empty and Existing::keep, or this build
/// writes no pictures; Error{output} for a name that cannot be a folder's.
void check_frames(const std::filesystem::path& folder, Existing existing);
/// Writes frame-0000.png and so on. A new folder appears once all pictures are in it. Where there is one already, its
/// files of such names are replaced or removed in the end, and all others stay. Where drawing is cancelled or fails,
/// the folder is what it was. Errors: as check_frames and write_picture; output; interrupted.
void write_frames(const std::filesystem::path& folder, const Film& film, Existing existing,
                  const ProgressCallback& progress);

/// Throws Error{usage}, before anything is flown, where there is no ffmpeg on the PATH, or the picture's sides are odd.
void check_video(const std::filesystem::path& path, const PictureOptions& picture);
/// Writes an MP4 through the program ffmpeg; the file appears whole or not at all. Errors: as check_video and
/// write_picture; output, with what ffmpeg says; interrupted.
void write_video(const std::filesystem::path& path, const Film& film, Existing existing,
                 const ProgressCallback& progress);

}  // namespace standoff::fly
