// SPDX-License-Identifier: Apache-2.0
// Files that are damaged, hostile, or of a kind that is not read: each has its message, and none a crash.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstring>
#include <random>

#include "files/deflate.h"
#include "io/field/format.h"
#include "odd_field.h"
#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/formats.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

Grid small_grid() { return {{3, 4, 5}, {-1, 2, 3}, {0.5, 0.25, 2}}; }

// Of those that are single files; stores are damaged in tests/io/zarr.
std::vector<FileFormat> file_formats() {
  std::vector<FileFormat> formats = field_formats();
  std::erase_if(formats, [](const FileFormat& format) { return format.folder; });
  return formats;
}

std::string bytes_of(const std::string& extension, bool nearest = false, bool compress = false) {
  const TempFolder folder;
  write_field(folder / ("a." + extension), odd_field(small_grid(), 1000, nearest), {.compress = compress});
  return read_bytes(folder / ("a." + extension));
}

void expect_refused(const std::string& extension, const std::string& bytes, const std::string& words) {
  const TempFolder folder;
  const auto path = folder / ("a." + extension);
  write_bytes(path, bytes);
  expect_error([&] { read_field(path); }, ErrorCode::input, words);
  expect_error([&] { read_field(path); }, ErrorCode::input, path.string() + ":");
}

// One replacement of text in a good file. Lengths may change: text headers say no lengths.
struct Change {
  const char* from;
  std::string to;
  const char* words;
};

void expect_changes_refused(const std::string& extension, const std::vector<Change>& changes, bool nearest = false) {
  const std::string good = bytes_of(extension, nearest);
  for (const Change& change : changes) {
    SCOPED_TRACE(std::string(change.from) + " -> " + change.to);
    const auto at = good.find(change.from);
    ASSERT_NE(at, std::string::npos);
    std::string bytes = good;
    expect_refused(extension, bytes.replace(at, std::strlen(change.from), change.to), change.words);
  }
}

TEST(DamagedField, MissingEmptyAndFolders) {
  const TempFolder folder;
  for (const FileFormat& format : file_formats()) {
    const auto path = folder / ("a." + format.extension);
    expect_error([&] { read_field(path); }, ErrorCode::input, path.string() + ": no such file");
    expect_refused(format.extension, "", ": the file is empty; write it again");
    std::filesystem::create_directory(path);
    expect_error([&] { read_field(path); }, ErrorCode::input, path.string() + ": it is a folder");
  }
}

TEST(DamagedField, OfAnotherKind) {
  for (const std::string bytes : {"x", "solid cube\nendsolid\n", "\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "PK\x05\x06"}) {
    expect_refused("vti", bytes, ":header: no appended data");
    expect_refused("nrrd", bytes, ":header: it does not begin with NRRD000");
    expect_refused("npz", bytes, ":directory: it is missing");
    expect_refused("vdb", bytes, ":header: it is no VDB file; check its name");
    expect_refused("nvdb", bytes, ":header: it is no NanoVDB file; check its name");
  }
}

TEST(DamagedField, Vti) {
  expect_changes_refused(
      "vti",
      {
          {"VTKFile type", "VTKFile typ", "<VTKFile> lacks type; write the file again"},
          {"type=\"ImageData\"", "type=\"PolyData\"", "it holds PolyData; save the field as ImageData"},
          {"byte_order", "compressor=\"vtkLZ4DataCompressor\" byte_order",
           "it is compressed by vtkLZ4DataCompressor, which is not read; save it with zlib, or plain"},
          {"byte_order=\"LittleEndian\"", "", "<VTKFile> lacks byte_order"},
          {"VTKFile type", "VTKFiles type", ":header: it is no VTK XML file"},
          {"  <ImageData", "  <Image", ":header: it holds no ImageData"},
          {"WholeExtent=\"0 2 0 3 0 4\"", "WholeExtent=\"0 2 0 3 0\"", "WholeExtent is not 6 numbers"},
          {"WholeExtent=\"0 2 0 3 0 4\"", "WholeExtent=\"0 2 0 3 0 x\"", "WholeExtent is not 6 numbers"},
          {"WholeExtent=\"0 2", "WholeExtent=\"2 0", "the piece is not all of the image"},
          {"WholeExtent=\"0 2", "WholeExtent=\"0 4398046511104", "WholeExtent is too large"},
          {"WholeExtent=\"0 2 0 3 0 4\"", "WholeExtent=\"0 1099511627775 0 1099511627775 0 1099511627775\"",
           "the piece is not all of the image"},
          {"Spacing=\"0.5", "Spacing=\"-0.5",
           ":header: grid: the spacing must be positive and finite; write the file again"},
          {"Spacing=\"0.5", "Spacing=\"nan",
           ":header: grid: the spacing must be positive and finite; write the file again"},
          {"Origin=\"-1", "Origin=\"inf", ":header: grid: the origin and extent must be finite; write the file again"},
          {"Direction=\"1 0", "Direction=\"0 1", "the axes of the grid must be those of the world; resample it"},
          {"<Piece Extent=\"0 2", "<Piece Extent=\"0 1",
           "the piece is not all of the image; save the whole as one piece"},
          {"<Piece Ext", "<Pi Ext", ":header: it has 0 pieces; save it as one"},
          {"Scalars=\"distance\"", "Scalars=distance", ":line 11: a damaged tag"},
          {"<FieldData>", "<FieldData", ":line 4: a tag inside a tag"},
          {"<FieldData>", "<!-- <FieldData>", ":line 4: a comment or section without an end"},
          {"format=\"appended\" offset=\"0\"", "format=\"binary\" offset=\"0\"",
           "facts are read from appended or ascii"},
          {"offset=\"0\"", "offset=\"-1\"", "the array's offset lies outside the file"},
          {"offset=\"0\"", "offset=\"99999\"", "the array's offset lies outside the file"},
          {"offset=\"0\"", "", "<DataArray> lacks offset"},
          {"Float64", "Float32", "the thickness is not of type Float64"},
          {"type=\"Float32\"", "type=\"Float64\"", "samples of type Float64 are not read; save them as Float32"},
          {"Name=\"distance\" format=\"appended\"", "Name=\"distance\" format=\"ascii\"",
           "the array is not in the appended data; save it with appended data"},
          {"Name=\"distance\"", "Name=\"distance\" NumberOfComponents=\"3\"", "it has 3 numbers per sample; save one"},
          {"UInt32", "Int64", "samples of type Int64 are not read; save them as UInt32"},
          {"Name=\"distance\"", "Name=\"other\"", ":header: its point data lacks an array 'distance'; name it so"},
          {"encoding=\"raw\"", "encoding=\"base64\"", "the appended data is not raw; save it with encoding raw"},
          {"<AppendedData encoding=\"raw\">\n_", "<AppendedData encoding=\"raw\">\n",
           "no '_' begins the appended data"},
          {"header_type=\"UInt64\"", "header_type=\"UInt32\"", "the thickness"},
      },
      true);
}

// Found by grammar: messages repeated words of a header however long, and the bytes in them, to the terminal.
TEST(DamagedField, MessagesShowTheBeginningOfLongWords) {
  const std::string word = "\x1b[2J" + std::string(100'000, '9'), shown = "?[2J" + std::string(36, '9') + "...";
  const auto changed = [&](const std::string& extension, const std::string& from, const std::string& to) {
    std::string bytes = bytes_of(extension);
    bytes.replace(bytes.find(from), from.size(), to);
    expect_refused(extension, bytes, shown);
    const TempFolder folder;
    const auto path = folder.file("a." + extension, bytes);
    try {
      read_field(path);
    } catch (const Error& error) {
      EXPECT_LT(std::strlen(error.what()), path.string().size() + 200) << from;
    }
  };
  changed("nrrd", "dimension: 3", "dimension: " + word);
  changed("nrrd", "type: float", "type: " + word);
  changed("nrrd", "encoding: raw", "encoding: " + word);
  changed("vti", "type=\"ImageData\"", "type=\"" + word + "\"");
  changed("vti", "type=\"Float32\"", "type=\"" + word + "\"");
  changed("vti", "type=\"Float32\"", "type=\"Float32\" NumberOfComponents=\"" + word + "\"");
}

TEST(DamagedField, MessagesShowTheBeginningOfLongNamesOfMembers) {
  std::string bytes = bytes_of("npz");
  const std::string name = "\x1b" + std::string(500, 'n');
  const auto entry = bytes.rfind("PK\x01\x02");
  bytes.replace(entry + 46, static_cast<unsigned char>(bytes[entry + 28]), name);
  const auto length = static_cast<std::uint16_t>(name.size());
  std::memcpy(bytes.data() + entry + 28, &length, sizeof length);
  bytes[entry + 10] = 9;  // a method that nobody uses
  expect_refused("npz", bytes, ":?" + std::string(39, 'n') + "...: it is packed by method 9, which is not read");
}

// A fuzzer's find: what looked like the last tag was none, and the reader took the last of no tags.
TEST(DamagedField, VtiWhoseAppendedDataIsNoTag) {
  expect_refused("vti", "<?xml <AppendedData encoding=\"raw\"?>_", "no tag begins the appended data");
  expect_refused("vti", "<?xml ?><!-- <AppendedData encoding=\"raw\">-->_", "no '_' begins the appended data");
  expect_refused("vti", "<X encoding=\"raw\"><AppendedDataset encoding=\"raw\">_", "no tag begins the appended data");
}

TEST(DamagedField, VtiLengths) {
  const std::string good = bytes_of("vti");
  const auto data = good.find("\n_") + 2;
  // thickness; "tiles"; the hash; "1.2.3"; each after 8 bytes of length.
  const auto distances = data + 16 + 8 + 6 + 8 + 19 + 8 + 6;
  const auto with_length = [&](std::size_t at, std::uint64_t length) {
    std::string bytes = good;
    std::memcpy(bytes.data() + at, &length, sizeof length);
    return bytes;
  };
  expect_refused("vti", with_length(data, 7), "the thickness is not one number");
  expect_refused("vti", with_length(data, ~std::uint64_t{0}), "reaches past the end of the file");
  expect_refused("vti", with_length(distances, 3 * 4 * 5 * 4 - 4), "it has 236 bytes, not 4 for each sample");
  expect_refused("vti", with_length(distances, std::uint64_t{1} << 62), "reaches past the end of the file");
}

TEST(DamagedField, Nrrd) {
  expect_changes_refused(
      "nrrd",
      {
          {"NRRD0005", "NRRX0005", ":header: it does not begin with NRRD000"},
          {"type: float", "type: double", ":line 3: samples of type 'double' are not read; convert them"},
          {"type: float\n", "", ":header: the field 'type' is missing"},
          {"type: float", "type float", ":line 3: 'type float' is no header field"},
          {"type: float", "type:", ":line 3: 'type:' is no header field"},
          {"encoding: raw", "encoding: bzip2", ": encoding 'bzip2' is not read; save it raw"},
          {"encoding: raw", "encoding: gzip", ": its packed bytes are damaged"},

          {"encoding: raw", "encoding: raw\ndata file: a.raw", ": samples in another file are not read"},
          {"encoding: raw", "encoding: raw\nbyte skip: -1", ": skips before the samples are not read"},
          {"dimension: 3", "dimension: 4", ": a field has 3 dimensions, not '4'"},
          {"sizes: 3 4 5", "sizes: 3 4", ": '3 4' is not three whole numbers"},
          {"sizes: 3 4 5", "sizes: 3 4 5.5", ": '3 4 5.5' is not three whole numbers"},
          {"sizes: 3 4 5", "sizes: 3 4 99999999999999999999", "is not three whole numbers"},
          {"sizes: 3 4 5", "sizes: 3 4 0", ":header: grid: every axis needs at least one sample"},
          {"sizes: 3 4 5", "sizes: 3 4 -5", ":header: grid: every axis needs at least one sample"},
          {"sizes: 3 4 5", "sizes: 3 4 6", "the array of distances of 288 bytes reaches past the end"},
          {"sizes: 3 4 5", "sizes: 1000000 1000000 1000000", "reaches past the end of the file"},
          {"sizes: 3 4 5", "sizes: 1 4398046511104 1048576", ":header: grid: too many samples"},
          {"sizes: 3 4 5", "sizes: 4194304 1048576 1048576", "reaches past the end of the file"},
          {"(0.5,0,0)", "(0.5,0,0", "is not three numbers"},
          {"(0,0,2)", "(0,0,2", "is not made of vectors (x,y,z)"},
          {"(0.5,0,0)", "none", "is not made of vectors (x,y,z)"},
          {"(0.5,0,0)", "(0.5,0)", "is not three numbers"},
          {"(0.5,0,0)", "(0.5,0.1,0)", "the axes of the grid must be those of the world"},
          {"(0.5,0,0)", "(-0.5,0,0)", ":header: grid: the spacing must be positive and finite; write the file again"},
          {"(0.5,0,0) ", "", "three directions are needed"},
          // A damaged name of a field was passed over: without its origin the grid began at 0.
          {"space origin:", "space orgin:", ":line 12: 'space orgin: (-1,2,3)' is no field of a NRRD header"},
          {"encoding: raw", "encoding: raw\ndatafile: a.raw", ": samples in another file are not read"},
          {"encoding: raw", "encoding: raw\nlineskip: 1", ": skips before the samples are not read"},
          {"space directions:", "# ", ":header: neither 'space directions' nor 'spacings' is there"},
          {"space origin: (-1,2,3)", "space origin: (-1,2,3) (1,2,3)", "one vector (x,y,z) is needed"},
          {"endian: little", "endian: middle", "endian is little or big"},
          {"endian: little\n", "", ":header: the field 'endian' is missing"},
          {"thickness:=1000", "thickness:=much", "the thickness is not a number"},
          {"thickness:=1000", "thickness:=-1", ": the thickness -1 is not positive"},
          {"thickness:=1000", "thickness:=nan", ": the thickness nan is not positive"},
          {"thickness:=1000", "thickness:=0.5", "larger in magnitude than the thickness, 0.5"},
          {"thickness:=1000", "thickness:=999",
           ":sample (0,0,2): the value 1000 is not a number, or larger in magnitude than the thickness, 999"},
      });
}

// Nothing is unpacked of a file that is too short for what it says, however little that is of it.
TEST(DamagedField, NrrdWhosePackedSamplesAreTooFew) {
  std::string bytes = bytes_of("nrrd");
  const auto set = [&](const std::string& from, const std::string& to) {
    bytes.replace(bytes.find(from), from.size(), to);
  };
  set("encoding: raw", "encoding: gz");
  set("sizes: 3 4 5", "sizes: 3000 4000 5000");
  expect_refused("nrrd", bytes, ":line 6: they ask for more samples than so short a file can hold");
}

// A key's name may hold a colon, which is not the one that ends a field's name.
TEST(DamagedField, NrrdKeysMayHoldColons) {
  const TempFolder folder;
  std::string bytes = bytes_of("nrrd");
  bytes.insert(bytes.find("thickness:="), "http://www.example.org/a:=b\ncontent: c:=d\n");
  write_bytes(folder / "a.nrrd", bytes);
  EXPECT_EQ(read_field(folder / "a.nrrd").grid(), small_grid());
}

long peak_kib() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  return used.ru_maxrss;
}

// Headers that promise 2^28 samples in one layer, and files of a MiB, which could just hold so many equal ones but hold
// a few. All the memory for a layer was written before the first byte was unpacked, which took seconds for 2^32
// samples.
TEST(DamagedField, LayersThatAreNotThereTakeNoMemory) {
  constexpr std::uint64_t kBytes = std::uint64_t{4} << 28;
  const std::string rest(kBytes / 1032 + 1024, 'x');
  const std::string packed = zlib_stream(std::string(4096, '\0'));
  const long before = peak_kib();

  std::string nrrd = bytes_of("nrrd", false, true);
  nrrd.resize(nrrd.find("\n\n") + 2);
  nrrd.replace(nrrd.find("sizes: 3 4 5"), 12, "sizes: 16384 16384 1");
  std::string gzip("\x1f\x8b\x08\0\0\0\0\0\0\xff", 10);
  gzip.append(packed.substr(2, packed.size() - 6));
  expect_refused("nrrd", nrrd + gzip + rest, "its packed bytes are damaged");

  std::string vti = R"(<VTKFile type="ImageData" byte_order="LittleEndian" header_type="UInt64"
 compressor="vtkZLibDataCompressor"><ImageData WholeExtent="0 16383 0 16383 0 0" Origin="0 0 0" Spacing="1 1 1">
<Piece Extent="0 16383 0 16383 0 0"><PointData><DataArray type="Float32" Name="distance" format="appended" offset="0"/>
</PointData></Piece></ImageData><AppendedData encoding="raw">_)";
  const std::uint64_t blocks[] = {1, kBytes, 0, packed.size() + rest.size()};
  vti.append(reinterpret_cast<const char*>(blocks), sizeof blocks);
  expect_refused("vti", vti + packed + rest, "it unpacks to fewer bytes than promised");

  constexpr long kShareOfLayer = static_cast<long>(kBytes >> 10) / 4;
  EXPECT_LT(peak_kib() - before, kShareOfLayer);
}

TEST(DamagedField, ValuesThatAreNoDistances) {
  std::string bytes = bytes_of("nrrd");
  const auto at = bytes.size() - 4 * (3 * 4 * 5) + 4 * (1 + 3 * (2 + 4 * 3));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), 1000.5f, std::numeric_limits<float>::infinity()}) {
    std::memcpy(bytes.data() + at, &bad, sizeof bad);
    expect_refused("nrrd", bytes, ":sample (1,2,3): the value ");
  }
}

DistanceField read_from_memory(const std::string& extension, const std::string& bytes) {
  const FileView file("a." + extension, bytes);
  // A damaged tree may span a grid of very many samples.
  return read_as(extension, file, {.memory_limit = find_field_format(extension)->sparse ? std::int64_t{64} << 20 : 0})
      .field;
}

// Whatever a file lost at its end is noticed.
TEST(DamagedField, TruncatedAnywhere) {
  for (const FileFormat& format : file_formats()) {
    const std::string good = bytes_of(format.extension, format.nearest);
    // A VTI is complete without its closing tags.
    const std::size_t needed = format.extension == "vti" ? good.rfind("\n  </AppendedData>") : good.size();
    const std::size_t step = good.size() / 5000 + 1;  // a tree's tables are long
    for (std::size_t size = 1; size < needed; size += step) {
      EXPECT_THROW(read_from_memory(format.extension, good.substr(0, size)), Error)
          << format.extension << " of " << size << " bytes";
    }
  }
}

// Random bytes in random places: an error or a field, nothing else.
TEST(DamagedField, RandomDamage) {
  for (const FileFormat& format : file_formats()) {
    const std::string good = bytes_of(format.extension, format.nearest);
    const bool tree = format.sparse;
    // Of a tree's tables, which are long and say little, only a few.
    std::vector<std::size_t> places;
    for (std::size_t n = 0; n < good.size(); ++n)
      if (!tree || n < 2000 || n + 2000 > good.size() || n % 100 == 0) places.push_back(n);
    std::mt19937 random(7);
    int refused = 0;
    for (int n = 0; n < (tree ? 600 : 4000); ++n) {
      std::string bytes = good;
      for (unsigned changes = 1 + random() % 4; changes > 0; --changes)
        bytes[places[random() % places.size()]] = static_cast<char>(random());
      try {
        const DistanceField field = read_from_memory(format.extension, bytes);
        EXPECT_LE(tree ? field.memory_bytes() / 64 : field.grid().sample_count(),
                  static_cast<std::int64_t>(tree ? std::size_t{1} << 20 : bytes.size()));
      } catch (const Error& error) {
        EXPECT_TRUE(error.code() == ErrorCode::input || (tree && error.code() == ErrorCode::limit)) << error.what();
        ++refused;
      }
    }
    EXPECT_GT(refused, tree ? 60 : 400) << format.extension;
  }
}

}  // namespace
}  // namespace standoff
