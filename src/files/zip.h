// SPDX-License-Identifier: Apache-2.0
// Unpacks deflated bytes, plain, of zlib and of gzip (RFC 1950 to 1952), by zlib; reads and writes zip archives (PKWARE
// APPNOTE 6.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/atomic_file.h"
#include "files/file_view.h"

namespace standoff {

/// One deflated byte inflates to at most this many bytes. A file that claims more is damaged.
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
  /// Does the same, but fewer bytes than `room` are an error.
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

/// Unpacks what gzip packed, front to back. It holds memory for the largest piece.
class GzipStream : public ByteStream {
 public:
  /// The file must outlive it.
  GzipStream(const FileView& file, std::string_view packed) : inflater_(file, "", packed, Inflater::Wrapper::gzip) {}

  std::string_view next(std::uint64_t bytes) override;
  /// Compares the checksum, which is at the end.
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

/// Returns how many bytes so many packed ones may become where nothing else bounds them. Meshes shrink to about a
/// tenth.
constexpr std::uint64_t most_unpacked(std::uint64_t packed) { return (std::uint64_t{64} << 20) + 64 * packed; }

/// Signatures and sizes of the records of an archive: section 4.3.
namespace zip {

inline constexpr std::uint32_t kLocalHeader = 0x04034b50;
inline constexpr std::uint32_t kDirectoryHeader = 0x02014b50;
inline constexpr std::uint32_t kDirectoryEnd = 0x06054b50;
inline constexpr std::uint32_t kDirectoryEnd64 = 0x06064b50;
inline constexpr std::uint32_t kLocator64 = 0x07064b50;

inline constexpr std::uint64_t kLocalHeaderBytes = 30;
inline constexpr std::uint64_t kDirectoryHeaderBytes = 46;
inline constexpr std::uint64_t kDirectoryEndBytes = 22;
inline constexpr std::uint64_t kDirectoryEnd64Bytes = 56;
inline constexpr std::uint64_t kLocator64Bytes = 20;

inline constexpr std::uint64_t kLocalCrcOffset = 14;  ///< of the checksum within a local header

inline constexpr std::uint16_t kExtra64 = 1;        ///< the extra field that holds 64-bit sizes and offsets
inline constexpr std::uint32_t kIn64 = 0xFFFFFFFF;  ///< stands for a value given there
inline constexpr std::uint16_t kCountIn64 = 0xFFFF;

}  // namespace zip

struct ZipMember {
  std::string name;
  std::uint64_t offset = 0;  ///< of its first byte in the archive
  std::uint64_t packed = 0;  ///< bytes there
  std::uint64_t bytes = 0;   ///< once unpacked; no more than packed ones can become
  std::uint32_t crc = 0;     ///< of the unpacked bytes
  bool deflated = false;     ///< as they are otherwise
};

/// The members of an archive, each of them within the file. Errors: input, also for archives that are encrypted, split
/// or packed by other means than deflate.
std::vector<ZipMember> read_zip(const FileView& file);

/// A member's bytes, checked against its checksum once all of them are read.
class ZipMemberStream : public ByteStream {
 public:
  /// All must outlive it.
  ZipMemberStream(const FileView& file, const ZipMember& member);

  /// Memory for the bytes is taken only where they are packed.
  std::string_view next(std::uint64_t bytes) override;
  void finish() override;

 private:
  [[noreturn]] void fail(const char* what) const;

  const FileView& file_;
  const ZipMember& member_;
  std::optional<Inflater> inflater_;
  UnpackedBytes buffer_;
  std::uint64_t done_ = 0;
  std::uint32_t crc_ = 0;
};

/// Members are written one after the other: begin, any number of writes, end; or begin_deflated, the deflated bytes,
/// end_deflated. Sizes past `zip64_from` are spelt in 64
/// bits; readers want that only from 4 GiB on, tests set it lower.
class ZipWriter {
 public:
  static constexpr std::uint64_t kZip64From = 0xFFFFFFFF;
  explicit ZipWriter(AtomicFile& file, std::uint64_t zip64_from = kZip64From) : file_(file), zip64_from_(zip64_from) {}

  /// Starts a member of exactly `bytes` bytes.
  void begin(const std::string& name, std::uint64_t bytes);
  void write(std::span<const std::byte> bytes);
  void end();
  /// Starts a member that unpacks to exactly `bytes` bytes.
  void begin_deflated(const std::string& name, std::uint64_t bytes);
  void write_deflated(std::string_view bytes) { file_.write(bytes.data(), bytes.size()); }
  /// With the checksum of what was deflated.
  void end_deflated(std::uint32_t crc);
  /// Writes the directory; the archive is complete, but not committed.
  void finish();

 private:
  struct Member {
    std::string name;
    std::uint64_t bytes = 0, packed = 0, header = 0;
    std::uint32_t crc = 0;
    bool deflated = false;
  };
  void begin(const Member& member);
  void write_text(const std::string& text) { file_.write(text.data(), text.size()); }

  AtomicFile& file_;
  std::uint64_t zip64_from_;
  std::vector<Member> members_;
};

}  // namespace standoff
