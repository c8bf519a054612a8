// SPDX-License-Identifier: Apache-2.0
// The meshes of a batch, one after the other: a file of paths, a folder, or the standard input. Nothing is held but
// what is being looked at, so that a list may have any length.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace standoff::cli {

/// A part of a list: the meshes whose place in it, from 0, leaves the remainder `part` - 1 when divided by `of`.
/// Neighbours in a list are often alike, so that this shares the work more evenly than pieces of the list do; unlike a
/// hash of the path it gives every part as many meshes, and it needs no list whose end is known.
struct Shard {
  std::int64_t part = 1;  ///< 1 to `of`
  std::int64_t of = 1;

  bool has(std::int64_t index) const { return index % of == part - 1; }
  /// "", or "-3-of-64": the ends of the names of a shard's files.
  std::string suffix() const;
};

/// "3/64". Errors: usage.
Shard parse_shard(const std::string& option, const std::string& text);

class Listing {
 public:
  enum class Next { mesh, not_yet, end };

  virtual ~Listing() = default;
  /// Sets `name` to the next mesh: as it stands in the list, or relative to the folder. `not_yet`: who writes the list
  /// has not come to it, and descriptor() becomes readable when there is more. Errors: input.
  virtual Next next(std::string& name) = 0;
  /// What to poll for after `not_yet`.
  virtual int descriptor() const { return -1; }
  /// Where a mesh lies: its name, or the folder and its name.
  virtual std::string path_of(const std::string& name) const { return name; }
  /// The finished share, 0 to 1; 0 where the end is unknown.
  virtual double fraction() const = 0;
};

/// A list of paths: one on each line, or ended by zero bytes with `zeros`, as find -print0 writes them. Empty ones are
/// passed over. `name` is a file, or - for the standard input. Or a folder: all files in it and below that have the
/// extension of a mesh, each folder's entries in the order of their bytes; symbolic links to folders are not followed,
/// and the folder `but` is left out. Errors: input; usage, for a mesh.
std::unique_ptr<Listing> open_listing(const std::string& name, bool zeros, const std::filesystem::path& but);

}  // namespace standoff::cli
