// SPDX-License-Identifier: Apache-2.0
#include "cli/batch/list.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <set>
#include <system_error>
#include <vector>

#include "cli/parse.h"
#include "files/file_view.h"
#include "standoff/error.h"
#include "standoff/io.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;

class PathList : public Listing {
 public:
  PathList(const std::string& name, bool zeros) : name_(name), end_(zeros ? '\0' : '\n') {
    if (name == "-") return;
    opened_ = open_to_read(name);
    if (opened_.number() < 0) throw Error(ErrorCode::input, name + ": " + cannot_read(errno), {.file = name});
    file_ = opened_.number();
    struct stat about {};
    if (::fstat(file_, &about) == 0 && S_ISREG(about.st_mode)) size_ = static_cast<std::uint64_t>(about.st_size);
  }

  Next next(std::string& name) override {
    for (;;) {
      const std::size_t found = text_.find(end_, at_);
      if (found == std::string::npos && !ended_) {
        if (!read_more()) return Next::not_yet;
        continue;
      }
      if (at_ == text_.size()) return Next::end;
      const std::size_t stop = std::min(found, text_.size());
      name.assign(text_, at_, stop - at_);
      at_ = std::min(stop + 1, text_.size());
      if (end_ == '\n' && name.ends_with('\r')) name.pop_back();  // of a list that Windows wrote
      if (!name.empty()) return Next::mesh;
    }
  }
  int descriptor() const override { return file_; }
  double fraction() const override {
    return size_ > 0 ? std::min(1.0, static_cast<double>(read_ - (text_.size() - at_)) / static_cast<double>(size_))
                     : 0;
  }

 private:
  static constexpr std::size_t kLongestName = std::size_t{1} << 16;

  // Whether there was something to read, or the end.
  bool read_more() {
    pollfd ready{file_, POLLIN, 0};
    if (::poll(&ready, 1, 0) == 0) return false;
    if (text_.size() - at_ > kLongestName)
      throw Error(ErrorCode::input, shown() + ": a path of more than " + std::to_string(kLongestName) +
                                        " bytes; give a list with a path on each line, or with -0 one that has zero "
                                        "bytes between them");
    text_.erase(0, at_);
    at_ = 0;
    char buffer[1 << 15];
    const auto count = ::read(file_, buffer, sizeof buffer);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) return false;
    if (count < 0) throw Error(ErrorCode::input, shown() + ": " + cannot_read(errno));
    ended_ = count == 0;
    text_.append(buffer, static_cast<std::size_t>(count));
    read_ += static_cast<std::uint64_t>(count);
    return true;
  }
  std::string shown() const { return name_ == "-" ? "standard input" : name_; }

  std::string name_;
  char end_;
  Descriptor opened_;
  int file_ = STDIN_FILENO;
  std::uint64_t size_ = 0, read_ = 0;
  std::string text_;  // what is read and not passed on
  std::size_t at_ = 0;
  bool ended_ = false;
};

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
}

bool is_mesh_name(const fs::path& name) {
  static const std::set<std::string> known = [] {
    std::set<std::string> extensions;
    for (const FileFormat& format : mesh_formats())
      if (format.readable) extensions.insert(format.extension);
    return extensions;
  }();
  const bool packed = lower_extension(name) == "gz";
  return known.contains(lower_extension(packed ? name.stem() : name));
}

class MeshFolder : public Listing {
 public:
  MeshFolder(const fs::path& folder, const fs::path& but) : folder_(folder) {
    std::error_code ignored;
    but_ = fs::weakly_canonical(but, ignored);
    enter("");
  }

  Next next(std::string& name) override {
    while (!waiting_.empty()) {
      const Entry entry = std::move(waiting_.back());
      waiting_.pop_back();
      if (entry.folder) {
        enter(entry.name);
        continue;
      }
      ++done_;
      name = entry.name;
      return Next::mesh;
    }
    return Next::end;
  }
  std::string path_of(const std::string& name) const override { return (folder_ / name).string(); }
  double fraction() const override {  // of what is known; it may fall behind when a folder shows more
    return static_cast<double>(done_) / static_cast<double>(std::max<std::size_t>(1, done_ + waiting_.size()));
  }

 private:
  struct Entry {
    std::string name;  // relative to the folder
    bool folder;
  };

  // Puts the entries of a folder before all that waits.
  void enter(const std::string& name) {
    const fs::path folder = name.empty() ? folder_ : folder_ / name;
    std::error_code error;
    if (fs::weakly_canonical(folder, error) == but_) return;
    std::vector<Entry> found;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      const std::string entry =
          name.empty() ? at->path().filename().string() : name + "/" + at->path().filename().string();
      std::error_code ignored;
      if (at->is_directory(ignored) && !at->is_symlink(ignored))
        found.push_back({entry, true});
      else if (is_mesh_name(at->path().filename()) && (at->is_regular_file(ignored) || !at->exists(ignored)))
        found.push_back({entry, false});
    }
    if (error)
      throw Error(ErrorCode::input, folder.string() + ": cannot read the folder: " + error.message() +
                                        "; see to its permissions, or give a list of paths");
    std::ranges::sort(found, [](const Entry& a, const Entry& b) { return a.name > b.name; });
    std::ranges::move(found, std::back_inserter(waiting_));
  }

  fs::path folder_, but_;
  std::vector<Entry> waiting_;  // the next one last
  std::size_t done_ = 0;
};

}  // namespace

std::string Shard::suffix() const { return of == 1 ? "" : "-" + std::to_string(part) + "-of-" + std::to_string(of); }

Shard parse_shard(const std::string& option, const std::string& text) {
  constexpr std::int64_t kMostShards = 1'000'000;
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos)
    throw Error(ErrorCode::usage, option + " '" + text + "': give a part and the number of parts, as 3/64");
  const std::int64_t of = parse_count(option, text.substr(slash + 1), 1, kMostShards);
  return {parse_count(option, text.substr(0, slash), 1, of), of};
}

std::unique_ptr<Listing> open_listing(const std::string& name, bool zeros, const fs::path& but) {
  std::error_code ignored;
  if (name != "-" && fs::is_directory(name, ignored)) {
    if (zeros) throw Error(ErrorCode::usage, "--null: it is for lists, and " + name + " is a folder; leave it out");
    return std::make_unique<MeshFolder>(name, but);
  }
  if (is_mesh_name(name) || name.starts_with("scene:"))
    throw Error(ErrorCode::usage, name +
                                      ": this is a mesh, and batch takes a list of meshes or a folder; for its "
                                      "field: standoff compute " +
                                      name);
  return std::make_unique<PathList>(name, zeros);
}

}  // namespace standoff::cli
