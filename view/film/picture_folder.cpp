// SPDX-License-Identifier: Apache-2.0
#include "view/film/picture_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <string_view>
#include <system_error>

#include "files/descriptor.h"
#include "files/temp_file.h"
#include "standoff/error.h"
#include "view/film/film.h"

namespace standoff::view {
namespace {

namespace fs = std::filesystem;

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

}  // namespace standoff::view
