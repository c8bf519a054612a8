// SPDX-License-Identifier: Apache-2.0
// Writes NumPy arrays into an .npz file, one after the other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "files/zip.h"
#include "io/field/npy.h"
#include "standoff/vec.h"

namespace standoff {

class NpzArrays {
 public:
  explicit NpzArrays(AtomicFile& file) : zip_(file) {}

  /// Starts an array of exactly `bytes` bytes: write() them, then end().
  void begin(const std::string& name, const NpyHeader& header, std::uint64_t bytes) {
    const std::string text = npy_header(header);
    zip_.begin(name + ".npy", text.size() + bytes);
    zip_.write(std::as_bytes(std::span(text)));
  }
  void write(std::span<const std::byte> bytes) { zip_.write(bytes); }
  void end() { zip_.end(); }
  /// The file is complete, but not committed.
  void finish() { zip_.finish(); }

  /// Three numbers, one per axis.
  void vector(const std::string& name, const Vec3& v) { numbers(name, "<f8", std::array{v.x, v.y, v.z}); }
  void size(const std::string& name, const Size3& v) { numbers(name, "<i8", std::array{v.x, v.y, v.z}); }

 private:
  template <class Number>
  void numbers(const std::string& name, const char* type, const std::array<Number, 3>& values) {
    begin(name, {type, {3}, false}, sizeof values);
    write(std::as_bytes(std::span(values)));
    end();
  }

  ZipWriter zip_;
};

}  // namespace standoff
