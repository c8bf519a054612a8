// SPDX-License-Identifier: Apache-2.0
// Bytes that are read front to back.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

namespace standoff {

/// A part of a file, unpacked as it is read. Errors: input, as `FILE:WHERE: ...`, for bytes that are missing or
/// damaged.
class ByteStream {
 public:
  ByteStream() = default;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  virtual ~ByteStream() = default;

  /// The next bytes, so many and no fewer. They live until the next call, or as long as the file's view.
  virtual std::string_view next(std::uint64_t bytes) = 0;
  /// Reads what is left, and checks the whole where the file holds a checksum.
  virtual void finish() = 0;
};

/// Room for what is unpacked next. Its pages are taken as they are written, so that a file that promises far more than
/// it holds is refused for the time and the memory of what it holds.
class UnpackedBytes {
 public:
  /// At least so many bytes, not set to anything. What was there before is lost.
  char* room(std::uint64_t bytes) {
    if (bytes > size_) {
      bytes_.reset();  // what is there is not kept beside it
      bytes_ = std::make_unique_for_overwrite<char[]>(bytes);
      size_ = bytes;
    }
    return bytes_.get();
  }

 private:
  std::unique_ptr<char[]> bytes_;
  std::uint64_t size_ = 0;
};

/// Bytes that lie in memory.
class BytesInMemory : public ByteStream {
 public:
  explicit BytesInMemory(std::string_view bytes) : left_(bytes) {}
  std::string_view next(std::uint64_t bytes) override {
    const std::string_view part = left_.substr(0, bytes);
    left_.remove_prefix(part.size());
    return part;
  }
  void finish() override {}

 private:
  std::string_view left_;
};

}  // namespace standoff
