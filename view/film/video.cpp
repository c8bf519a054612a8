// SPDX-License-Identifier: Apache-2.0
#include "view/film/video.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

#include "files/atomic_file.h"
#include "standoff/error.h"
#include "view/film/film.h"

extern char** environ;

namespace standoff::view {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostWords = 600;  // of what ffmpeg says: its last ones

// Empty if there is none. Only in folders that the PATH names whole: an empty or relative one means where we stand.
fs::path program_ffmpeg() {
  const char* const paths = std::getenv("PATH");
  for (std::string_view rest = paths ? paths : ""; !rest.empty();) {
    const std::size_t end = rest.find(':');
    const fs::path folder = rest.substr(0, end), program = folder / "ffmpeg";
    std::error_code ignored;
    if (folder.is_absolute() && fs::is_regular_file(program, ignored) && ::access(program.c_str(), X_OK) == 0)
      return program;
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  return {};
}

// Pixels as they come, to what every player shows.
std::vector<std::string> arguments_of(const fs::path& ffmpeg, const fs::path& out, int width, int height, double rate) {
  return {ffmpeg.string(),
          "-hide_banner",
          "-loglevel",
          "error",
          "-nostdin",
          "-y",
          "-f",
          "rawvideo",
          "-pixel_format",
          "rgb24",
          "-video_size",
          std::to_string(width) + "x" + std::to_string(height),
          "-framerate",
          std::to_string(rate),
          "-i",
          "pipe:0",
          "-vf",
          "scale=out_color_matrix=bt709:out_range=tv",
          "-pix_fmt",
          "yuv420p",
          "-colorspace",
          "bt709",
          "-color_primaries",
          "bt709",
          "-color_trc",
          "bt709",
          "-movflags",
          "+faststart",
          "-f",
          "mp4",
          "file:" + out.string()};
}

}  // namespace

void check_video(const fs::path& path, const PictureOptions& picture) {
  require_png();  // a build that lacks it draws no pictures
  if (picture.width % 2 != 0 || picture.height % 2 != 0)
    throw Error(ErrorCode::usage, path.string() + ": a video's width and height must be even, not " +
                                      std::to_string(picture.width) + "x" + std::to_string(picture.height) +
                                      "; give another size");
  if (program_ffmpeg().empty())
    throw Error(ErrorCode::usage, path.string() +
                                      ": videos are made by the program ffmpeg, which is not on the PATH; install it "
                                      "(Debian: ffmpeg), or write a page (.html) or a folder of pictures (NAME/)");
}

Video::Video(const fs::path& path, int width, int height, double frames_per_second)
    : shown_(path), made_(".mp4", ""), said_(".txt", "") {
  PictureOptions size;
  size.width = width, size.height = height;
  check_video(path, size);
  int ends[2];
  const auto refuse = [&](int error) {
    throw Error(ErrorCode::output,
                shown_.string() + ": ffmpeg cannot be started: " + std::strerror(error) + "; try again");
  };
  if (::pipe2(ends, O_CLOEXEC) != 0) refuse(errno);
  const Descriptor source(ends[0]);
  pixels_ = Descriptor(ends[1]);

  const fs::path ffmpeg = program_ffmpeg();
  std::vector<std::string> words = arguments_of(ffmpeg, made_.path(), width, height, frames_per_second);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  if (const int error = ::posix_spawn_file_actions_init(&actions)) refuse(error);
  if (const int error = ::posix_spawnattr_init(&attributes)) {
    ::posix_spawn_file_actions_destroy(&actions);
    refuse(error);
  }
  ::posix_spawn_file_actions_adddup2(&actions, source.number(), STDIN_FILENO);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, said_.path().c_str(), O_WRONLY, 0);
  sigset_t usual;
  sigemptyset(&usual);
  for (const int signal : {SIGPIPE, SIGXFSZ}) sigaddset(&usual, signal);  // which this program ignores
  ::posix_spawnattr_setsigdefault(&attributes, &usual);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  const int error = ::posix_spawn(&ffmpeg_, ffmpeg.c_str(), &actions, &attributes, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  if (error != 0) {
    ffmpeg_ = -1;
    refuse(error);
  }
}

Video::~Video() {
  if (ffmpeg_ > 0) ::kill(ffmpeg_, SIGKILL);
  wait();
}

void Video::add(const Image& image) {
  std::string_view bytes(reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size() * sizeof(Color));
  while (!bytes.empty()) {
    const auto written = ::write(pixels_.number(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail();
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void Video::commit(Existing existing) {
  pixels_ = Descriptor();
  if (!wait()) fail();
  const std::string bytes = read_text(made_.path());
  if (bytes.empty()) fail();
  write_text(shown_, bytes, existing);
}

bool Video::wait() {
  if (ffmpeg_ <= 0) return true;
  int status = 0;
  while (::waitpid(ffmpeg_, &status, 0) < 0)
    if (errno != EINTR) break;
  ffmpeg_ = -1;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void Video::fail() {
  pixels_ = Descriptor();
  wait();
  std::string said = read_text(said_.path());
  while (!said.empty() && (said.back() == '\n' || said.back() == ' ')) said.pop_back();
  if (said.size() > kMostWords) said = ".." + said.substr(said.size() - kMostWords);
  throw Error(ErrorCode::output,
              shown_.string() + ": ffmpeg has failed: " + (said.empty() ? std::string("it says nothing") : said) +
                  "; see to that, or write a folder of pictures (NAME/)",
              {.file = shown_.string()});
}

}  // namespace standoff::view
