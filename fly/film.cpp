// SPDX-License-Identifier: Apache-2.0
#include "fly/film.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "files/atomic_file.h"
#include "files/file_view.h"
#include "fly/flight_pictures.h"
#include "render/image.h"
#include "standoff/error.h"
#include "standoff/existing.h"

extern char** environ;

namespace standoff::fly {
namespace {

namespace fs = std::filesystem;

/// Pictures that become a folder, all or none. They are written into an unfinished folder, `.standoff-*.part`, inside
/// the folder that is there, or beside the folder to be. The destructor removes it.
class PictureFolder {
 public:
  /// For pictures numbered up to `count` - 1. Errors: as check_frames.
  PictureFolder(const std::filesystem::path& folder, std::size_t count, Existing existing);
  PictureFolder(const PictureFolder&) = delete;
  PictureFolder& operator=(const PictureFolder&) = delete;
  ~PictureFolder();

  /// Errors: output.
  void add(const Image& image);
  /// Puts the pictures where they belong. Errors: output.
  void commit();

 private:
  [[noreturn]] void fail(const std::error_code& why) const;
  void replace_old();

  std::filesystem::path shown_, folder_, unfinished_;
  std::vector<std::filesystem::path> names_;
  std::size_t digits_;
  Existing existing_;
  int slot_ = -1;  // in the table of unfinished files
};

constexpr std::string_view kBegin = "frame-", kEnd = ".png";
constexpr std::size_t kLeastDigits = 4;

std::string name_of(std::size_t number, std::size_t digits) {
  std::string text = std::to_string(number);
  text.insert(0, text.size() < digits ? digits - text.size() : 0, '0');
  return std::string(kBegin) + text + std::string(kEnd);
}

// Whether a file may be a picture of an earlier film.
bool is_frame(std::string_view name) {
  if (!name.starts_with(kBegin) || !name.ends_with(kEnd)) return false;
  const std::string_view number = name.substr(kBegin.size(), name.size() - kBegin.size() - kEnd.size());
  return number.size() >= kLeastDigits && std::ranges::all_of(number, [](char c) { return c >= '0' && c <= '9'; });
}

// "frames" for "frames/", with links followed.
fs::path plain(const fs::path& folder) {
  std::error_code ignored;
  fs::path path = fs::weakly_canonical(fs::absolute(folder, ignored), ignored);
  return path.has_filename() ? path : path.parent_path();
}

std::string unfinished_name() {
  const auto now = static_cast<unsigned long long>(std::chrono::system_clock::now().time_since_epoch().count());
  return ".standoff-" + std::to_string(now) + "-" + std::to_string(::getpid()) + ".part";
}

}  // namespace

void check_frames(const fs::path& folder, Existing existing) {
  require_png();
  std::error_code ignored;
  const fs::path there = plain(folder), parent = there.parent_path();
  if (fs::exists(there, ignored) && !fs::is_directory(there, ignored))
    throw Error(ErrorCode::output, folder.string() + ": it is a file; give another name for the folder of pictures");
  const bool exists = fs::exists(there, ignored);
  if (!exists && !fs::is_directory(parent, ignored))
    throw Error(ErrorCode::output,
                folder.string() + ": the folder " + parent.string() + " does not exist; create it first");
  if (::access(exists ? there.c_str() : parent.c_str(), W_OK | X_OK) != 0)
    throw Error(ErrorCode::output, folder.string() + ": permission denied; choose a folder that you may write");
  if (exists && existing == Existing::keep && !fs::is_empty(there, ignored))
    throw Error(ErrorCode::usage, folder.string() +
                                      ": the folder is not empty; give -f to replace the pictures of an earlier film "
                                      "in it, or another name");
}

PictureFolder::PictureFolder(const fs::path& folder, std::size_t count, Existing existing)
    : shown_(folder),
      folder_(plain(folder)),
      digits_(std::max(kLeastDigits, std::to_string(std::max<std::size_t>(count, 1) - 1).size())),
      existing_(existing) {
  check_frames(folder, existing);
  std::error_code why;
  const fs::path unfinished = (fs::is_directory(folder_, why) ? folder_ : folder_.parent_path()) / unfinished_name();
  if (!fs::create_directory(unfinished, why)) fail(why);
  unfinished_ = unfinished;
  slot_ = note_unfinished(unfinished_);
}

PictureFolder::~PictureFolder() {
  std::error_code ignored;
  if (!unfinished_.empty()) fs::remove_all(unfinished_, ignored);
  forget_unfinished(slot_);
}

void PictureFolder::add(const Image& image) {
  names_.emplace_back(name_of(names_.size(), digits_));
  write_png(unfinished_ / names_.back(), image, Existing::keep);
}

void PictureFolder::commit() {
  std::error_code why;
  if (unfinished_.parent_path() == folder_) {
    replace_old();
    return;
  }
  const Descriptor pictures(::open(unfinished_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  note_finishing(shown_, pictures.number());
  fs::rename(unfinished_, folder_, why);  // also over an empty folder that has appeared meanwhile
  if (why) fail(why);
  unfinished_.clear();
}

// The pictures move up into the folder that was there.
void PictureFolder::replace_old() {
  std::error_code why;
  if (existing_ == Existing::keep)
    for (const auto& entry : fs::directory_iterator(folder_, why))
      if (entry.path() != unfinished_)
        throw Error(ErrorCode::output, shown_.string() + ": somebody has put " + entry.path().filename().string() +
                                           " into the folder meanwhile; give another name");
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder_, why))
    if (is_frame(entry.path().filename().string())) old.push_back(entry.path());
  for (const fs::path& name : names_) {
    fs::rename(unfinished_ / name, folder_ / name, why);
    if (why) fail(why);
  }
  for (const fs::path& path : old)
    if (std::ranges::find(names_, path.filename()) == names_.end()) fs::remove(path, why);
  const Descriptor pictures(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  note_finishing(shown_, pictures.number());
}

void PictureFolder::fail(const std::error_code& why) const {
  throw Error(
      ErrorCode::output,
      shown_.string() + ": cannot write it: " + why.message() + "; check the folder and its disk, and try again",
      {.file = shown_.string()});
}

namespace {

/// A video that the program ffmpeg makes of pictures. ffmpeg reads pixels from a pipe and writes a temporary file,
/// whose bytes the video gets in the end. It is started without a shell, and in a process group of its own, so that a
/// Ctrl-C means this program alone.
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
  /// Waits until ffmpeg ends; true if it succeeded.
  bool wait();
  [[noreturn]] void fail();

  std::filesystem::path shown_;
  TempFile made_, said_;
  Descriptor pixels_;
  pid_t ffmpeg_ = -1;
};

constexpr std::size_t kMostWords = 600;  // of what ffmpeg says: its last ones

// Empty if there is none. Folders that the PATH names relatively are skipped: they depend on the current folder.
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

namespace {

// Gives one picture after another to `add`.
template <class Add>
void draw_all(const Film& film, const ProgressCallback& progress, const Add& add) {
  FlightPictures pictures(film.subject, film.frames, film.frames_per_second, film.picture);
  const std::size_t count = film.frames.size();
  for (std::size_t n = 0; n < count; ++n) {
    if (progress && !progress({"draw", static_cast<double>(n) / static_cast<double>(count)}))
      throw Error(ErrorCode::interrupted, "interrupted");
    add(pictures.next());
  }
}

}  // namespace

void write_frames(const std::filesystem::path& folder, const Film& film, Existing existing,
                  const ProgressCallback& progress) {
  PictureFolder pictures(folder, film.frames.size(), existing);
  draw_all(film, progress, [&](const Image& image) { pictures.add(image); });
  pictures.commit();
}

void write_video(const std::filesystem::path& path, const Film& film, Existing existing,
                 const ProgressCallback& progress) {
  Video video(path, film.picture.width, film.picture.height, film.frames_per_second);
  draw_all(film, progress, [&](const Image& image) { video.add(image); });
  video.commit(existing);
}

}  // namespace standoff::fly
