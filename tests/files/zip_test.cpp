// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "files/zip.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

// Two members; sizes and offsets from `zip64_from` on in 64 bits.
void write_archive(const std::filesystem::path& path, std::uint64_t zip64_from) {
  AtomicFile file(path);
  ZipWriter zip(file, zip64_from);
  zip.begin("first", 5);
  zip.write(bytes_of("he"));
  zip.write(bytes_of("llo"));
  zip.end();
  zip.begin("second", 300);
  zip.write(bytes_of(std::string(300, 's')));
  zip.end();
  zip.finish();
  file.commit();
}

class Zip : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  void SetUp() override { write_archive(folder / "a.zip", GetParam()); }
  const TempFolder folder;
};
// Nothing, the second member's size, both offsets, and everything in 64 bits.
INSTANTIATE_TEST_SUITE_P(Widths, Zip, ::testing::Values(ZipWriter::kZip64From, 300, 40, 0));

TEST_P(Zip, IsReadAsWritten) {
  const FileView file(folder / "a.zip");
  const auto members = read_zip(file);
  ASSERT_EQ(members.size(), 2u);
  EXPECT_EQ(members[0].name, "first");
  EXPECT_EQ(file.text(members[0].offset, members[0].bytes), "hello");
  EXPECT_EQ(members[1].name, "second");
  EXPECT_EQ(file.text(members[1].offset, members[1].bytes), std::string(300, 's'));
  for (const ZipMember& member : members) ZipMemberStream(file, member).finish();
}

TEST_P(Zip, IsReadByPython) {
  const std::string command = std::string(kPython) +
                              " -B -c 'import sys, zipfile; z = zipfile.ZipFile(sys.argv[1]); "
                              "sys.exit(z.testzip() is not None or z.read(\"first\") != b\"hello\" or "
                              "z.read(\"second\") != b\"s\" * 300 or len(z.namelist()) != 2)' '" +
                              (folder / "a.zip").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

TEST_P(Zip, MayEndWithAComment) {
  std::string bytes = read_bytes(folder / "a.zip");
  bytes[bytes.size() - 2] = 7;
  bytes += "comment";
  EXPECT_EQ(read_zip(FileView("a.zip", bytes)).size(), 2u);
}

void expect_refused(const std::string& bytes, const std::string& words) {
  const FileView file("a.zip", bytes);
  expect_error(
      [&] {
        for (const ZipMember& member : read_zip(file)) ZipMemberStream(file, member).finish();
      },
      ErrorCode::input, words);
}

TEST(DamagedZip, SaysWhatIsWrong) {
  const TempFolder folder;
  write_archive(folder / "a.zip", ZipWriter::kZip64From);
  const std::string good = read_bytes(folder / "a.zip");
  const auto entry = good.find("PK\1\2"), end = good.find("PK\5\6");
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return std::string(good).replace(at, bytes.size(), bytes);
  };
  expect_refused(with(entry + 8, "\1"), "a.zip:first: it is encrypted; save it without a password");
  expect_refused(with(entry + 10, "\14"), "a.zip:first: it is packed by method 12, which is not read");
  expect_refused(with(entry + 10, "\10"), "a.zip:first: its packed bytes are damaged; get the file again");
  expect_refused(with(entry + 20, "\4"), "a.zip:first: its sizes contradict each other");
  expect_refused(with(entry + 42, "\7"), "a.zip:first: its header is damaged");
  expect_refused(with(entry + 42, "\377\377\377\177"), "a record of the archive of 30 bytes reaches past the end");
  expect_refused(with(entry, "X"), "a.zip:directory: entry 1 is damaged");
  expect_refused(with(good.find("hello"), "j"), "a.zip:first: its checksum is wrong; the file is damaged");
  expect_refused(with(entry + 20, std::string("\5\0\0\1\5\0\0\1", 8)),
                 "a member of 16777221 bytes reaches past the end");
  expect_refused(with(end + 10, "\3"), "reaches past the end of the file");
  expect_refused(with(end + 12, "\377\377"), "the archive's directory of 65535 bytes reaches past the end");
  expect_refused(with(end + 16, "\377\377\377\377"), "a.zip:directory: its 64-bit part is missing");
  expect_refused(good.substr(0, good.size() - 1), "a.zip:directory: it is missing");
  expect_refused("", "a.zip:directory: it is missing");
}

// What Python's zipfile makes of these members, and reads.
std::string packed_by_python(const std::string& members) {
  const TempFolder folder;
  const std::string command = std::string(kPython) +
                              " -B -c 'import sys, zipfile; z = zipfile.ZipFile(sys.argv[1], \"w\", "
                              "zipfile.ZIP_DEFLATED); " +
                              members + "; z.close()' '" + (folder / "a.zip").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  return read_bytes(folder / "a.zip");
}

TEST(DeflatedZip, IsReadInPiecesOfAnySize) {
  const std::string bytes =
      packed_by_python(R"(z.writestr("numbers", " ".join(str(n * n) for n in range(20000))); z.writestr("empty", ""))");
  std::string numbers;
  for (std::uint64_t n = 0; n < 20000; ++n) numbers += (n ? " " : "") + std::to_string(n * n);
  const FileView file("a.zip", bytes);
  const auto members = read_zip(file);
  ASSERT_EQ(members.size(), 2u);
  EXPECT_TRUE(members[0].deflated);
  EXPECT_LT(members[0].packed, members[0].bytes);
  for (const std::uint64_t piece : {std::uint64_t{1}, std::uint64_t{7}, std::uint64_t{4096}, members[0].bytes}) {
    ZipMemberStream stream(file, members[0]);
    std::string read;
    while (read.size() < members[0].bytes) read += stream.next(std::min(piece, members[0].bytes - read.size()));
    EXPECT_EQ(read, numbers) << piece;
    stream.finish();
    expect_error([&] { stream.next(1); }, ErrorCode::input, "a.zip:numbers: it is shorter than its content says");
  }
  EXPECT_EQ(ZipMemberStream(file, members[1]).next(0), "");
}

TEST(DeflatedZip, SaysWhatIsDamaged) {
  const std::string good = packed_by_python(R"(z.writestr("zeros", "0" * 3000))");
  const auto entry = good.find("PK\1\2");
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return std::string(good).replace(at, bytes.size(), bytes);
  };
  expect_refused(with(entry + 16, "\1"), "a.zip:zeros: its checksum is wrong");
  expect_refused(with(entry + 20, "\4"), "a.zip:zeros: its packed bytes are cut off");
  expect_refused(with(entry + 24, std::string("\xb9\x0b", 2)), "a.zip:zeros: it unpacks to fewer bytes than promised");
  expect_refused(with(30 + 5 + 4, "\377\377"), "a.zip:zeros: its packed bytes are damaged");
  // More than deflate can pack: no memory is taken for it.
  expect_refused(with(entry + 24, "\377\377\377"), "a.zip:zeros: its sizes contradict each other");
}

TEST(DamagedZip, SaysWhatIsWrongWithItsWideParts) {
  const TempFolder folder;
  write_archive(folder / "a.zip", 0);
  const std::string good = read_bytes(folder / "a.zip");
  const auto entry = good.find("PK\1\2"), end = good.find("PK\6\6"), locator = good.find("PK\6\7");
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return std::string(good).replace(at, bytes.size(), bytes);
  };
  expect_refused(with(end, "X"), "a.zip:directory: its 64-bit part is damaged");
  expect_refused(with(locator + 8, "\377\377\377\377\377\377\377\377"),
                 "a record of the archive of 56 bytes reaches past");
  expect_refused(with(end + 48, "\377\377\377\377\377\377\377\377"), "the archive's directory");
  // The extra field behind the name "first": kind 1, 24 bytes, of which fewer are said to be there.
  expect_refused(with(entry + 46 + 5 + 2, "\10"), "a.zip:first: its 64-bit sizes are damaged");
  expect_refused(with(entry + 46 + 5, "\2"), "reaches past the end of the file");
}

}  // namespace
}  // namespace standoff
