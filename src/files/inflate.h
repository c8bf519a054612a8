// SPDX-License-Identifier: Apache-2.0
// Unpacks what zip and gzip pack: deflated bytes (RFC 1951, RFC 1952), by zlib.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "files/file_view.h"

namespace standoff {

/// No deflated byte becomes more than this many. A file that claims more is damaged.
inline constexpr std::uint64_t kMostDeflated = 1032;

class Inflater {
 public:
  enum class Wrapper {
    none,  ///< as in zip archives
    zlib,  ///< with zlib's header and checksum, which is checked
    gzip,  ///< with its headers, lengths and checksums, which are checked; several streams in a row are one
  };

  /// Unpacks `packed`, a part of the file's bytes; `where` stands in messages.
  Inflater(const FileView& file, std::string where, std::string_view packed, Wrapper wrapper);
  ~Inflater();

  /// Fills `to` with the next `room` bytes and returns how many they are: fewer than `room` at the end alone. Memory is
  /// bounded whatever the file says. Errors: input, where the packed bytes are damaged or cut off.
  std::size_t read(char* to, std::size_t room);
  /// The same, where fewer bytes than `room` are an error.
  void fill(char* to, std::size_t room);

 private:
  struct State;

  bool begin_next_stream();
  [[noreturn]] void fail(const char* what) const;

  const FileView& file_;
  std::string where_;
  std::string_view left_;  // packed, not given to zlib yet
  Wrapper wrapper_;
  std::unique_ptr<State> state_;
  bool ended_ = false;
};

/// What gzip packed, front to back. Memory for the largest piece is taken.
class GzipStream : public ByteStream {
 public:
  /// The file must outlive it.
  GzipStream(const FileView& file, std::string_view packed) : inflater_(file, "", packed, Inflater::Wrapper::gzip) {}

  std::string_view next(std::uint64_t bytes) override;
  /// The checksum is at the end.
  void finish() override;

 private:
  Inflater inflater_;
  UnpackedBytes buffer_;
};

/// Whether the content is packed by gzip.
bool is_gzip(std::string_view content);

/// The bytes a gzip file holds, under its name. A few packed bytes can become very many: errors: limit, for more than
/// 64 MiB and 64 times the file's size; input, for damaged ones.
std::unique_ptr<FileView> unpack_gzip(const FileView& file);

/// Most bytes that so many packed ones may become where nothing else bounds them. Meshes shrink to a tenth or so.
constexpr std::uint64_t most_unpacked(std::uint64_t packed) { return (std::uint64_t{64} << 20) + 64 * packed; }

}  // namespace standoff
