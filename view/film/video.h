// SPDX-License-Identifier: Apache-2.0
// A video that the program ffmpeg makes of pictures.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

#include "files/descriptor.h"
#include "files/temp_file.h"
#include "render/image.h"
#include "standoff/existing.h"

namespace standoff::view {

/// ffmpeg reads pixels from a pipe and writes into a temporary file, whose bytes the video gets in the end. It is
/// started without a shell, and in a process group of its own, so that a Ctrl-C means this program alone.
class Video {
 public:
  /// Errors: usage (no ffmpeg on the PATH, odd sides), output.
  Video(const std::filesystem::path& path, int width, int height, double frames_per_second);
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;
  /// Ends ffmpeg where it still runs.
  ~Video();

  /// Errors: output, with what ffmpeg says.
  void add(const Image& image);
  /// Waits for ffmpeg, and writes the file. Errors: the same.
  void commit(Existing existing);

 private:
  /// Waits for ffmpeg's end; whether it was content.
  bool wait();
  [[noreturn]] void fail();

  std::filesystem::path shown_;
  TempFile made_, said_;
  Descriptor pixels_;
  pid_t ffmpeg_ = -1;
};

}  // namespace standoff::view
