// SPDX-License-Identifier: Apache-2.0
// What OpenVDB's files are made of.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "standoff/vec.h"

namespace standoff::vdb {

inline constexpr std::uint64_t kMagic = 0x56444220;
inline constexpr std::uint32_t kVersion = 224;
inline constexpr std::uint32_t kOldest = 222;  ///< the first one whose values are stored as they are since
inline constexpr std::string_view kNoId = "00000000-0000-0000-0000-000000000000";  ///< equal fields make equal files
inline constexpr std::string_view kFloatTree = "Tree_float_5_4_3", kHalfSuffix = "_HalfFloat";

/// Bits of a grid's compression.
inline constexpr std::uint32_t kZip = 1, kActiveMask = 2, kBlosc = 4;

/// How the values of a node that are not active are found.
enum class ValuesKind : std::uint8_t {
  background,              ///< all of them are
  negative,                ///< all are -background
  one,                     ///< all are a value that follows
  background_or_negative,  ///< a mask says which are the background
  background_or_one,       ///< a value follows, and a mask of those that are the background
  two,                     ///< two values follow, and a mask of those that are the second
  all,                     ///< every value is stored
};

inline constexpr const char *kSizeFact = "standoff_size", *kThicknessFact = "standoff_thickness",
                            *kMethodFact = "standoff_method", *kHashFact = "standoff_mesh_hash",
                            *kVersionFact = "standoff_version", *kSignFact = "standoff_sign";

/// The front of a grid: how it is compressed, facts, and the transform.
class FactWriter {
 public:
  void text(const std::string& name, const std::string& value) { fact(name, "string", value); }
  void flag(const std::string& name, bool value) { fact(name, "bool", std::string(1, value ? '\1' : '\0')); }
  template <class Numbers>
  void numbers(const std::string& name, const std::string& type, const Numbers& values) {
    fact(name, type, {reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]});
  }

  std::string grid_front(const Vec3& origin, const Vec3& spacing) const {
    std::string front;
    add(front, kActiveMask);
    add(front, count_);
    front += bytes_;
    const Vec3 h = spacing;
    add_text(front, h.x == h.y && h.y == h.z ? "UniformScaleTranslateMap" : "ScaleTranslateMap");
    for (const Vec3& v : {origin, h, h, Vec3{1 / h.x, 1 / h.y, 1 / h.z},
                          Vec3{1 / h.x / h.x, 1 / h.y / h.y, 1 / h.z / h.z}, Vec3{0.5 / h.x, 0.5 / h.y, 0.5 / h.z}})
      for (const double x : {v.x, v.y, v.z}) add(front, x);
    return front;
  }

 private:
  template <class Number>
  static void add(std::string& to, Number value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  static void add_text(std::string& to, const std::string& text) {
    add(to, static_cast<std::uint32_t>(text.size()));
    to += text;
  }
  void fact(const std::string& name, const std::string& type, const std::string& value) {
    add_text(bytes_, name);
    add_text(bytes_, type);
    add_text(bytes_, value);
    ++count_;
  }

  std::string bytes_;
  std::uint32_t count_ = 0;
};

}  // namespace standoff::vdb
