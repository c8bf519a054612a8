// SPDX-License-Identifier: Apache-2.0
// What arrays an .npz must hold, and what is said where they are others.
#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "files/zip.h"
#include "io/field/npy.h"
#include "odd_field.h"
#include "tests/support/expect_error.h"
#include "tests/support/formats.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

struct Array {
  NpyHeader header;
  std::string bytes;
};
using Arrays = std::map<std::string, Array>;

template <class Number>
std::string raw(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

Arrays good_arrays() {
  return {{"distance", {{"<f4", {3, 2, 1}, true}, raw<float>({1, 2, 3, 4, 5, 6})}},
          {"nearest_triangle", {{"<u4", {3, 2, 1}, true}, raw<std::uint32_t>({0, 1, 2, 3, 4, 5})}},
          {"origin", {{"<f8", {3}, false}, raw<double>({1, 2, 3})}},
          {"spacing", {{"<f8", {3}, false}, raw<double>({4, 5, 6})}},
          {"thickness", {{"<f8", {}, false}, raw<double>({7})}}};
}

DistanceField read(const std::map<std::string, std::string>& members) {
  const TempFolder folder;
  AtomicFile file(folder / "a.npz");
  ZipWriter zip(file);
  for (const auto& [name, bytes] : members) {
    zip.begin(name + ".npy", bytes.size());
    zip.write(std::as_bytes(std::span(bytes)));
    zip.end();
  }
  zip.finish();
  file.commit();
  return read_as("npz", FileView(folder / "a.npz"), {}).field;
}

DistanceField read(const Arrays& arrays) {
  std::map<std::string, std::string> members;
  for (const auto& [name, array] : arrays) members[name] = npy_header(array.header) + array.bytes;
  return read(members);
}

TEST(Npz, GoodArraysAreRead) {
  const DistanceField field = read(good_arrays());
  EXPECT_EQ(field.value(2, 0, 0), 3);
  EXPECT_EQ(field.value(0, 1, 0), 4);
  EXPECT_EQ(field.nearest(1, 1, 0), 4u);
  EXPECT_EQ(field.thickness(), 7);
  EXPECT_EQ(field.provenance().method, "");
}

TEST(Npz, NumbersOfOtherTypesAreRead) {
  Arrays arrays = good_arrays();
  arrays["origin"] = {{"<i8", {3}, false}, raw<std::int64_t>({-1, 2, 3})};
  arrays["spacing"] = {{"<f4", {1, 3}, false}, raw<float>({0.5, 2, 3})};
  arrays["thickness"] = {{"<i8", {1}, false}, raw<std::int64_t>({9})};
  const DistanceField field = read(arrays);
  EXPECT_EQ(field.grid(), (Grid{{3, 2, 1}, {-1, 2, 3}, {0.5, 2, 3}}));
  EXPECT_EQ(field.thickness(), 9);
}

TEST(Npz, COrderIsRead) {
  Arrays arrays = good_arrays();
  arrays["distance"].header.fortran_order = arrays["nearest_triangle"].header.fortran_order = false;
  const DistanceField field = read(arrays);
  EXPECT_EQ(field.value(0, 1, 0), 2);
  EXPECT_EQ(field.value(1, 0, 0), 3);
  EXPECT_EQ(field.nearest(1, 0, 0), 2u);
}

TEST(Npz, WrongArraysAreNamed) {
  const auto refused = [](const std::string& name, const Array& array, const std::string& words) {
    Arrays arrays = good_arrays();
    arrays[name] = array;
    expect_error([&] { read(arrays); }, ErrorCode::input, "a.npz:" + name + ".npy: " + words);
  };
  const std::string six = raw<float>({1, 2, 3, 4, 5, 6});
  refused("distance", {{"<f8", {3, 2, 1}, true}, six + six}, "its type is '<f8'; save it as '<f4'");
  refused("distance", {{"|O", {3, 2, 1}, true}, six}, "its type is '|O'; save it as '<f4'");
  refused("distance", {{"<f4", {6}, true}, six}, "it has not three axes");
  refused("distance", {{"<f4", {3, 2, 2}, true}, six}, "it is shorter than its shape says");
  refused("distance", {{"<f4", {3, 0, 2}, true}, six}, "it is shorter than its shape says");
  refused("distance", {{"<f4", {std::int64_t{1} << 62, std::int64_t{1} << 62, 16}, true}, six}, "it is shorter than");
  refused("nearest_triangle", {{"<u4", {1, 2, 3}, true}, six}, "its shape or order is not that of 'distance'");
  refused("nearest_triangle", {{"<u4", {3, 2, 1}, false}, six}, "its shape or order is not that of 'distance'");
  refused("nearest_triangle", {{"<i4", {3, 2, 1}, true}, six}, "its type is '<i4'; save it as '<u4'");
  refused("origin", {{"<f8", {2}, false}, raw<double>({1, 2})}, "it is not 3 number(s) of type float64");
  refused("origin", {{"<f8", {3}, false}, raw<double>({1, 2})}, "it is not 3 number(s) of type float64");
  refused("origin", {{"<f8", {3, 3}, false}, std::string(72, '\0')}, "it is not 3 number(s) of type float64");
  refused("thickness", {{"<U1", {}, false}, "abcd"}, "it is not 1 number(s) of type float64");
  refused("method", {{"<f8", {}, false}, raw<double>({1})}, "it is not a short string");
  refused("method", {{"<U9", {}, false}, "abcd"}, "it is not a short string");
  refused("method", {{"<U99999999", {}, false}, "abcd"}, "it is not a short string");
}

TEST(Npz, MissingArraysAreNamed) {
  for (const char* name : {"distance", "origin", "spacing"}) {
    Arrays arrays = good_arrays();
    arrays.erase(name);
    expect_error([&] { read(arrays); }, ErrorCode::input,
                 "a.npz: the array '" + std::string(name) + "' is missing; save it too");
  }
  Arrays arrays = good_arrays();
  arrays.erase("thickness");
  EXPECT_EQ(read(arrays).thickness(), kInfinite);
}

// The header of an array as text: what Python may write, and what it may not.
TEST(Npy, HeadersInAllSpellings) {
  const auto read_header = [](const std::string& bytes) {
    const FileView view("a.npy", bytes);
    return read_npy(view, "x.npy", bytes, bytes.size());
  };
  const auto header = [](std::string text, char version = 1) {
    const auto length = static_cast<std::uint32_t>(text.size());
    std::string bytes = std::string("\x93NUMPY") + version + '\0';
    bytes.append(reinterpret_cast<const char*>(&length), version == 1 ? 2 : 4);
    return bytes + text;
  };
  const std::string plain = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }\n";
  for (const char version : {'\1', '\2', '\3'}) {
    const NpyArray array = read_header(header(plain, version) + "data");
    EXPECT_EQ(array.type, "<f4");
    EXPECT_EQ(array.shape, (std::vector<std::int64_t>{2, 3}));
    EXPECT_FALSE(array.fortran_order);
    EXPECT_EQ(array.bytes, 4u);
  }
  EXPECT_EQ(read_header(header("{\"shape\":(5,),\"descr\":\">u4\",\"fortran_order\":True}")).shape.at(0), 5);
  EXPECT_TRUE(read_header(header("{'descr': '<f8', 'fortran_order': True, 'shape': ()}  \n")).shape.empty());

  for (const char* text :
       {"", "{}", "{'descr': '<f4'}", "{'descr': '<f4', 'fortran_order': 1, 'shape': (2,)}",
        "{'descr': [('a', '<f4')], 'fortran_order': True, 'shape': (2,)}",
        "{'descr': '<f4', 'fortran_order': True, 'shape': 2}",
        "{'descr': '<f4', 'fortran_order': True, 'shape': (-2,)}",
        "{'descr': '<f4', 'fortran_order': True, 'shape': (2", "{'descr': '<f4, 'fortran_order': True, 'shape': (2,)}",
        "{'descr': '<f4', 'fortran_order': True, 'shape': (2,)} more",
        "{'descr': '<f4', 'fortran_order': True, 'shape': (2,), 'more': 1}",
        "{'descr': '<f4', 'fortran_order': True, 'shape': (99999999999999999999,)}"})
    expect_error([&] { read_header(header(text)); }, ErrorCode::input,
                 "a.npy:x.npy: its header describes no plain array");
  expect_error([&] { read_header("NUMPY"); }, ErrorCode::input, "x.npy: it is no NumPy array");
  expect_error([&] { read_header(header(plain, '\4')); }, ErrorCode::input,
               "its version of the NumPy format is unknown");
  expect_error([&] { read_header(header(plain).substr(0, 30)); }, ErrorCode::input, "its header reaches past its end");
}

}  // namespace
}  // namespace standoff
