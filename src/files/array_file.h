// SPDX-License-Identifier: Apache-2.0
// Files that hold arrays as they lie in memory, little endian, with a checksum at the end: bodies and queries.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "core/hashes.h"
#include "files/atomic_file.h"
#include "files/file_view.h"

namespace standoff {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

/// How the files of bodies and of queries begin (src/collision/body/model_file.cpp, src/points/query_file.cpp): readers
/// of meshes tell them apart by it.
inline constexpr std::string_view kBodyMagic = "so.body\n";
inline constexpr std::string_view kQueryMagic = "so.quer\n";

/// Eight bytes at a time. A round is a third of splitmix64, for speed: it can be undone, so no changed word goes
/// unseen. It finds damage, not malice.
class WordChecksum {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* at = static_cast<const unsigned char*>(data);
    for (; bytes >= 8; bytes -= 8, at += 8) {
      std::uint64_t word;
      std::memcpy(&word, at, 8);
      mix(word);
    }
    std::uint64_t word = bytes;
    for (std::size_t n = 0; n < bytes; ++n) word = word << 8 | at[n];
    mix(word);
  }
  std::uint64_t value() const { return hash_; }

 private:
  void mix(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 0xbf58476d1ce4e5b9u;
    hash_ ^= hash_ >> 29;
  }
  std::uint64_t hash_ = kSplitmixStep;
};

/// Writes arrays, one after the other, and the checksum over them.
class ArrayFileWriter {
 public:
  ArrayFileWriter(const std::filesystem::path& path, Existing existing) : file_(path, existing) {}

  void put(const void* data, std::size_t bytes) {
    file_.write(data, bytes);
    sum_.add(data, bytes);
  }
  template <class Array>
  void put_all(const Array& array) {
    put(array.data(), array.size() * sizeof(array[0]));
  }
  void commit() {
    const std::uint64_t value = sum_.value();
    file_.write(&value, sizeof value);
    file_.commit();
  }

 private:
  AtomicFile file_;
  WordChecksum sum_;
};

enum class ArrayChecksum {
  checked,
  ignored,  ///< for fuzzers, whose changed bytes would end at it
};

/// Reads them again. Errors: input, which say `what` ("body") is to be saved again.
class ArrayFileReader {
 public:
  ArrayFileReader(const FileView& file, const char* what) : file_(file), what_(what) {}

  /// A header that begins with its magic, and says its version.
  template <class Header>
  void take_header(Header& header, std::string_view magic, std::uint32_t version) {
    const std::string what = what_;
    if (file_.size() < sizeof header + sizeof(std::uint64_t) || !file_.bytes().starts_with(magic))
      file_.fail("", "this is no " + what + " that standoff saved; give a mesh, or save a " + what + " again");
    std::memcpy(&header, file_.bytes().data(), sizeof header);
    sum_.add(&header, sizeof header);
    at_ = sizeof header;
    if (header.version != version)
      fail("header", "version " + std::to_string(header.version) + " is not known to this standoff, which knows " +
                         std::to_string(version));
  }
  template <class Vector>
  void take(Vector& to, std::uint64_t count) {
    using T = typename Vector::value_type;
    // Division, for the product may overflow.
    if (count > (file_.size() - at_) / sizeof(T)) fail("byte " + std::to_string(at_), "the file ends too early");
    to.resize(count);
    if (count > 0) std::memcpy(to.data(), file_.bytes().data() + at_, count * sizeof(T));
    sum_.add(to.data(), count * sizeof(T));
    at_ += count * sizeof(T);
  }
  /// What is left must be the checksum.
  void end(ArrayChecksum checksum) {
    std::uint64_t stored = 0;
    if (file_.size() - at_ != sizeof stored) fail("", "its length is not what its header says");
    std::memcpy(&stored, file_.bytes().data() + at_, sizeof stored);
    if (checksum == ArrayChecksum::checked && stored != sum_.value())
      fail("", "it is damaged: its checksum is not that of its content");
  }
  [[noreturn]] void fail(const std::string& where, const std::string& message) const {
    file_.fail(where, message + "; save the " + what_ + " again");
  }

 private:
  const FileView& file_;
  const char* what_;
  std::size_t at_ = 0;
  WordChecksum sum_;
};

}  // namespace standoff
