// SPDX-License-Identifier: Apache-2.0
// Stores that are damaged, hostile, or of a kind that is not read: each has its message, which names the file.
// labels: memory
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <cstring>
#include <random>
#include <vector>

#include "io/zarr/shard.h"
#include "standoff/io.h"
#include "standoff/zarr.h"
#include "tests/io/field/odd_field.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

// A store of one shard of 2 x 1 x 2 chunks, all of which are stored.
class DamagedZarr : public ::testing::Test {
 protected:
  void SetUp() override { write(true); }
  void write(bool compress) {
    std::filesystem::remove_all(path);
    const DistanceField field = odd_field(grid, 9000);
    ZarrStore::create(path, grid, 9000, {}, {.shard = {16, 16, 16}, .chunk = {8, 16, 8}, .compress = compress})
        .write({}, field);
    // Without their checksum, so that changes are refused for what they are.
    with_sum = read_bytes(array);
    const auto sum = with_sum.find(R"(, "metadata_crc32c")");
    write_bytes(array, with_sum.substr(0, sum) + with_sum.substr(with_sum.find("}", sum)));
  }
  void expect_refused(const std::filesystem::path& file, const std::string& words) const {
    expect_error([&] { read_field(path); }, ErrorCode::input, words);
    expect_error([&] { read_field(path); }, ErrorCode::input, file.string() + ":");
  }
  // Replaces a part of a text, tries, and puts the text back.
  void expect_change_refused(const std::filesystem::path& file, const std::string& from, const std::string& to,
                             const std::string& words) const {
    SCOPED_TRACE(from + " -> " + to);
    const std::string good = read_bytes(file);
    const auto at = good.find(from);
    ASSERT_NE(at, std::string::npos);
    std::string bad = good;
    write_bytes(file, bad.replace(at, from.size(), to));
    expect_refused(file, words);
    write_bytes(file, good);
  }
  // Makes of it a store whose chunks have no checksums, as standoff wrote them before and others do.
  void unchecked() const {
    std::string text = read_bytes(array);
    const std::string codec = R"(, {"name": "crc32c"})";
    write_bytes(array, text.erase(text.find(codec), codec.size()));
    ZarrStore::open(path).write({}, odd_field(grid, 9000));
  }
  // The index of the shard, changed, with its checksum made good.
  std::string with_entry(const Size3& chunk, std::uint64_t offset, std::uint64_t bytes) const {
    std::string file = read_bytes(shard);
    const std::size_t size = zarr::ShardIndex::size_of({2, 1, 2});
    zarr::ShardIndex index({2, 1, 2});
    EXPECT_TRUE(index.read(std::as_bytes(std::span(file).last(size))));
    index[chunk] = {offset, bytes};
    const std::vector<std::byte> changed = index.bytes();
    std::memcpy(file.data() + file.size() - size, changed.data(), size);
    return file;
  }

  const TempFolder folder;
  std::string with_sum;  // the array's metadata
  const Grid grid{{16, 9, 16}, {-1, 2, 3}, {0.5, 0.25, 2}};
  const std::filesystem::path path = folder / "a.zarr", group = path / "zarr.json", array = path / "0" / "zarr.json",
                              shard = path / "0" / "c" / "0" / "0" / "0";
};

TEST_F(DamagedZarr, TheCorpusIsGood) { EXPECT_EQ(read_field(path).grid(), grid); }

TEST_F(DamagedZarr, NoStores) {
  expect_error([&] { read_field(folder / "none.zarr"); }, ErrorCode::input, "none.zarr: no such file; check the name");
  write_bytes(folder / "file.zarr", "x");
  expect_error([&] { read_field(folder / "file.zarr"); }, ErrorCode::input,
               "it is a file, and a Zarr store is a folder");
  std::filesystem::create_directory(folder / "b.zarr");
  expect_error([&] { read_field(folder / "b.zarr"); }, ErrorCode::input, "b.zarr: the folder holds no zarr.json");
  write_bytes(folder / "b.zarr" / ".zarray", "{}");
  expect_error([&] { read_field(folder / "b.zarr"); }, ErrorCode::input, "it is a store of version 2 of Zarr");
  std::filesystem::remove(array);
  expect_refused(array, "no such file");
}

TEST_F(DamagedZarr, Groups) {
  for (const auto& [from, to, words] : std::vector<std::array<const char*, 3>>{
           {"\"zarr_format\": 3", "\"zarr_format\": 2", "it is of version 2 of Zarr, and version 3 is read"},
           {"\"group\"", "\"grp\"", "it is of type 'grp', where group is expected"},
           {"{", "{\"extension\": 1, ", "its member 'extension' is unknown here"},
           {"{\"name\": \"x\"", "{\"name\": \"z\"", "axes are read in the order x, y, z"},
           {"\"path\": \"0\"", "\"path\": \"../0\"", "'../0' is no array of this store"},
           {"\"path\": \"0\"", "\"path\": \"/\"", "'/' is no array of this store"},
           {"\"path\": \"0\"", "\"path\": \"\"", "'' is no array of this store"},
           {"\"type\": \"scale\"", "\"type\": \"affine\"", "a transformation of type 'affine' is not read"},
           {"\"scale\": [", "\"scale\": [1, ", "it has 4 numbers, where a field has 3 axes"},
           {"\"axes\"", "\"axles\"", "it lacks \"axes\""},
           {"}\n", "", "its JSON is damaged"}})
    expect_change_refused(group, from, to, words);
  write_bytes(group, "");
  expect_refused(group, "the file is empty");
}

TEST_F(DamagedZarr, Arrays) {
  for (const auto& [from, to, words] : std::vector<std::array<const char*, 3>>{
           {"\"array\"", "\"group\"", "it is of type 'group', where array is expected"},
           {"[16, 9, 16]", "[16, 9]", "it has 2 numbers, where a field has 3 axes"},
           {"[16, 9, 16]", "[16, 0, 16]", "a size is 1 to 2^40"},
           {"[16, 9, 16]", "[16, 2000000000000, 16]", "a size is 1 to 2^40"},
           {"[16, 9, 16]", "[16, 9.5, 16]", "expected a whole number"},
           {"float32", "float64", "samples of type 'float64' are not read; write float32"},
           {"float32", "uint32", "distances are of type float32"},
           {"[\"x\", \"y\", \"z\"]", "[\"z\", \"y\", \"x\"]", "axes are read in the order x, y, z"},
           {"[\"x\", \"y\", \"z\"]", "[\"x\", \"y\", \"z\", \"t\"]", "axes are read in the order x, y, z"},
           {"\"regular\"", "\"rectangular\"", "chunks in a grid 'rectangular' are not read"},
           {"\"default\"", "\"v2\"", "chunks named by 'v2' are not read"},
           {"\"separator\": \"/\"", "\"separator\": \"-\"", "the separator is \"/\" or \".\""},
           {"\"fill_value\": 9000", "\"fill_value\": \"0xgggggggg\"", "the fill value is no float32"},
           {"\"fill_value\": 9000", "\"fill_value\": \"much\"", "expected a number, \"Infinity\" or \"NaN\""},
           {"\"fill_value\"", "\"fill\"", "its member 'fill' is unknown here"},
           {"\"order\": [2, 1, 0]", "\"order\": [1, 2, 0]",
            "axes in this order are not read; standoff reads chunks of"},
           {"\"endian\": \"little\"", "\"endian\": \"big\"",
            "'big' endian bytes are not read; standoff reads chunks of"},
           {"\"blosc\"", "\"zstd\"", "codec 'zstd' is not read here; standoff reads chunks of"},
           {"\"blosc\"", "\"gzip\"", "codec 'gzip' is not read here"},
           {"\"name\": \"bytes\"", "\"name\": \"packbits\"", "codec 'packbits' is not read here"},
           {"[8, 16, 8]", "[8, 16, 6]", "a shard is no multiple of its chunks"},
           {"[8, 16, 8]", "[1000000000000, 16, 8]", "a shard is no multiple of its chunks"},
           {"\"index_location\": \"end\"", "\"index_location\": \"middle\"", "an index is at \"start\" or \"end\""},
           {"{\"name\": \"crc32c\"}], \"index_location", "{\"name\": \"gzip\"}], \"index_location",
            "the index of a shard is read of bytes"},
           {", {\"name\": \"crc32c\"}], \"index_location", "], \"index_location",
            "the index of a shard is read of bytes"},
           {"\"format\": 1", "\"format\": 2", "the store is of format 2, and format 1 is read; get a newer standoff"},
           {"\"origin\"", "\"orgin\"", "it lacks \"origin\""},
           {"\"spacing\": [0.5", "\"spacing\": [-0.5",
            "the spacing must be positive and finite; write the store again"},
           {"\"thickness\": 9000", "\"thickness\": -1", "the thickness -1 is not positive"},
           {"\"thickness\": 9000", "\"thickness\": \"NaN\"", "the thickness nan is not positive"},
           {"\"mesh_hash\": \"0x", "\"mesh_hash\": \"", "the mesh's hash is not of the form"},
           {"\"codecs\": [{\"name\": \"sharding_indexed\"",
            "\"codecs\": [{\"name\": \"bytes\"}, {\"name\": \"sharding_indexed\"",
            "codecs beside 'sharding_indexed' are not read"},
           {"\"configuration\": {\"chunk_shape\": [8", "\"config\": {\"chunk_shape\": [8", "lacks its configuration"}})
    expect_change_refused(array, from, to, words);
}

// Sizes that no memory holds are refused by what they are, before anything is taken.
TEST_F(DamagedZarr, HostileSizes) {
  const std::string text = read_bytes(array);
  const auto with = [&](std::vector<std::pair<std::string, std::string>> changes) {
    std::string bad = text;
    for (const auto& [from, to] : changes) bad.replace(bad.find(from), from.size(), to);
    write_bytes(array, bad);
  };
  with({{"\"chunk_shape\": [16, 16, 16]", "\"chunk_shape\": [1099511627776, 1099511627776, 1099511627776]"}});
  expect_refused(array, "a shard has more than 1048576 chunks");
  with({{"\"chunk_shape\": [16, 16, 16]", "\"chunk_shape\": [1099511627776, 1099511627776, 1099511627776]"},
        {"[8, 16, 8]", "[1099511627776, 1099511627776, 1099511627776]"}});
  expect_refused(array, "a chunk has more than 256 MiB");
  with({{"[16, 9, 16]", "[1099511627776, 1099511627776, 1099511627776]"}});
  expect_refused(array, "too many samples");
  with({{"[16, 9, 16]", "[1048576, 1048576, 1048576]"}});
  expect_error([&] { read_field(path); }, ErrorCode::limit, "a.zarr: its tiles need more than");
  expect_error([&] { read_field(path, {.memory_limit = -1}); }, ErrorCode::limit, "");
}

TEST_F(DamagedZarr, DeepJson) {
  write_bytes(array, std::string(100'000, '['));
  expect_refused(array, "its JSON is nested more than 32 deep");
}

TEST_F(DamagedZarr, TornShards) {
  const std::string good = read_bytes(shard);
  const std::size_t index = zarr::ShardIndex::size_of({2, 1, 2});
  for (std::size_t size = 0; size < good.size(); size += size < index ? 1 : 37) {
    write_bytes(shard, good.substr(0, size));
    if (size < index)
      expect_refused(shard, "index: the file has " + std::to_string(size) + " bytes, where its index alone has 68");
    else
      expect_refused(shard, "index: its checksum is wrong; the file is damaged, write the store again");
  }
  write_bytes(shard, good + "x");
  expect_refused(shard, "index: its checksum is wrong");
}

TEST_F(DamagedZarr, Indices) {
  const std::string good = read_bytes(shard);
  for (std::size_t at = good.size() - 68; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 4);
    write_bytes(shard, bad);
    expect_refused(shard, "index: its checksum is wrong");
  }
  write_bytes(shard, good);
  constexpr std::uint64_t kMost = ~std::uint64_t{0};
  for (const auto& [offset, bytes] : std::vector<std::pair<std::uint64_t, std::uint64_t>>{
           {0, good.size() + 1}, {good.size() + 1, 0}, {kMost, 1}, {1, kMost}, {kMost - 1, kMost - 1}, {kMost, 0}}) {
    write_bytes(shard, with_entry({1, 0, 1}, offset, bytes));
    expect_refused(shard, "chunk (1,0,1): it reaches past the end of the file");
    write_bytes(shard, good);
  }
  // Within the file, but not a chunk.
  write_bytes(shard, with_entry({0, 0, 1}, 0, 0));
  expect_refused(shard, "chunk (0,0,1): it has 0 bytes");
  write_bytes(shard, good);
  write_bytes(shard, with_entry({0, 0, 1}, 3, 60));
  expect_refused(shard, "chunk (0,0,1): its checksum is wrong");
}

TEST_F(DamagedZarr, ChunksOfAnotherLength) {
  write(false);
  const std::string good = read_bytes(shard);
  write_bytes(shard, with_entry({1, 0, 0}, 0, 8192));
  expect_refused(shard, "chunk (1,0,0): it has 8192 bytes, where 4100 are needed");
  write_bytes(shard, good);
  write_bytes(shard, with_entry({1, 0, 0}, ~std::uint64_t{0}, ~std::uint64_t{0}));
  EXPECT_NO_THROW(read_field(path)) << "a chunk that is not stored";
}

// The header of a chunk says how long it is and how long it becomes: blosc would believe it.
TEST_F(DamagedZarr, BloscHeaders) {
  unchecked();
  const std::string good = read_bytes(shard);
  const auto with = [&](std::size_t at, std::uint32_t number) {
    std::string bad = good;
    std::memcpy(bad.data() + at, &number, sizeof number);
    write_bytes(shard, bad);
  };
  constexpr std::size_t kBytes = 4, kPacked = 12;
  for (const std::uint32_t number : {0u, 1u, 4092u, 4100u, 0x7fffffffu, 0xffffffffu}) {
    with(kBytes, number);
    expect_refused(shard, "chunk (0,0,0): its blosc header");
    with(kPacked, number);
    expect_refused(shard, "chunk (0,0,0): its blosc header is damaged");
  }
}

TEST_F(DamagedZarr, ValuesThatNoFieldHas) {
  write(false);
  unchecked();
  const std::string good = read_bytes(shard);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), 9000.5f, -std::numeric_limits<float>::infinity()}) {
    std::string bytes = good;
    std::memcpy(bytes.data() + 4 * (3 + 8 * (2 + 16 * 5)), &bad, sizeof bad);
    write_bytes(shard, bytes);
    expect_error([&] { read_field(path); }, ErrorCode::input, "0:sample (3,2,5): the value ");
  }
}

TEST_F(DamagedZarr, ChunksWithoutChecksumsAreReadAndWritten) {
  const std::string checked = read_bytes(shard);
  unchecked();
  EXPECT_EQ(read_bytes(shard).size() + 4 * std::size_t{4}, checked.size()) << "four chunks";
  const DistanceField field = read_field(path);
  EXPECT_TRUE(field.to_dense() == odd_field(grid, 9000).to_dense());
}

// Bits of every file: an error that names the file, or the same field. Of a shard always an error.
TEST_F(DamagedZarr, NoBitIsFlippedUnseen) {
  for (const bool compress : {true, false}) {
    write(compress);
    write_bytes(array, with_sum);
    const DistanceField right = read_field(path);
    for (const auto& file : {group, array, shard}) {
      const std::string good = read_bytes(file);
      int same = 0;
      const std::size_t step = good.size() > 8192 ? 1009 : 61;  // the whole takes a minute
      for (std::size_t bit = 0; bit < 8 * good.size(); bit += step) {
        std::string bytes = good;
        bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
        write_bytes(file, bytes);
        try {
          const DistanceField field = read_field(path);
          ++same;
          ASSERT_TRUE(field.grid() == right.grid() && field.thickness() == right.thickness() &&
                      field.to_dense() == right.to_dense())
              << file << " bit " << bit;
        } catch (const Error& error) {
          ASSERT_EQ(error.code(), ErrorCode::input) << error.what();
          const std::string text = error.what();
          ASSERT_TRUE(file != shard || text.starts_with(shard.string() + ":chunk (") ||
                      text.starts_with(shard.string() + ":index"))
              << text;
        }
      }
      EXPECT_TRUE(same == 0 || file != shard) << same;
      write_bytes(file, good);
    }
  }
}

TEST_F(DamagedZarr, ChangedMetadata) {
  write_bytes(array, with_sum);
  expect_change_refused(array, "\"shape\": [16, 9, 16]", "\"shape\": [16, 8, 16]",
                        "it is not the checksum of this metadata");
  expect_change_refused(array, "\"separator\": \"/\"", "\"separator\": \".\"",
                        "it is not the checksum of this metadata");
  expect_change_refused(array, "\"fill_value\": 9000", "\"fill_value\": 900",
                        "it is not the checksum of this metadata");
  expect_change_refused(array, "\"attributes\": {\"standoff\"", "\"attributes\": {\"standofg\"",
                        "its attributes lack \"standoff\"");
  const std::string good = read_bytes(group);
  std::string bad = good;
  write_bytes(group, bad.replace(bad.find("[0.5, "), 6, "[0.6, "));
  expect_refused(group, "scale and translation of '0' are not the spacing and origin");
  // Spaces, and the order of members, mean nothing: other programs write them anew.
  write_bytes(group, good);
  std::string spaced;
  for (const char c : with_sum) spaced += c == ',' ? std::string(" ,\n") : std::string(1, c);
  write_bytes(array, spaced);
  EXPECT_EQ(read_field(path).grid(), grid);
}

// What is no regular file is never waited for, and never read.
TEST_F(DamagedZarr, PipesFoldersAndLinks) {
  for (const auto& file : {group, array, shard}) {
    const std::string good = read_bytes(file);
    std::filesystem::remove(file);
    ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
    expect_refused(file, "it is no regular file");
    std::filesystem::remove(file);
    std::filesystem::create_directory(file);
    expect_refused(file, "it is no regular file");
    std::filesystem::remove(file);
    std::filesystem::create_symlink("/dev/zero", file);
    expect_refused(file, "it is no regular file");
    std::filesystem::remove(file);
    std::filesystem::create_symlink("nowhere", file);
    expect_refused(file, "it is a link to what is not there");
    std::filesystem::remove(file);
    write_bytes(file, good);
  }
  for (const auto& file : {group, array}) {
    const std::string good = read_bytes(file);
    std::filesystem::resize_file(file, (std::uintmax_t{16} << 20) + 1);
    expect_refused(file, "it has more than 16 MiB");
    write_bytes(file, good);
  }
  std::filesystem::remove_all(path / "0" / "c" / "0");
  write_bytes(path / "0" / "c" / "0", "");
  expect_refused(shard, "a file is where its folder should be");
}

TEST_F(DamagedZarr, ArraysAlone) {
  EXPECT_EQ(read_field(path / "0").grid(), grid);
  EXPECT_EQ(read_field(path / "0" / "").grid(), grid);
  expect_error([&] { read_field(path / "1"); }, ErrorCode::input, "the name has no extension");
}

// Random bytes in random places: an error or a field, nothing else.
TEST_F(DamagedZarr, RandomDamage) {
  std::mt19937 random(7);
  for (const bool compress : {true, false}) {
    write(compress);
    for (const auto& file : {group, array, shard}) {
      const std::string good = read_bytes(file);
      int refused = 0;
      for (int n = 0; n < 400; ++n) {
        std::string bytes = good;
        for (unsigned changes = 1 + random() % 4; changes > 0; --changes)
          bytes[random() % bytes.size()] = static_cast<char>(random());
        write_bytes(file, bytes);
        try {
          const DistanceField field = read_field(path, {.memory_limit = std::int64_t{64} << 20});
          EXPECT_GT(field.thickness(), 0);
        } catch (const Error& error) {
          EXPECT_TRUE(error.code() == ErrorCode::input || error.code() == ErrorCode::limit) << error.what();
          ++refused;
        }
      }
      EXPECT_GT(refused, compress ? 100 : 10) << file;
      write_bytes(file, good);
    }
  }
}

}  // namespace
}  // namespace standoff
