// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <new>
#include <string>
#include <system_error>

#include "core/guarded.h"
#include "core/memory.h"
#include "core/progress.h"
#include "files/atomic_file.h"
#include "files/file_view.h"
#include "files/text.h"
#include "io/field/format.h"
#include "io/field/write_samples.h"
#include "standoff/error.h"
#include "standoff/io.h"

namespace standoff {
namespace {

#define STANDOFF_ROW(format) &kField##format,
constexpr const FieldFormat* kFieldFormats[] = {STANDOFF_FIELD_FORMATS(STANDOFF_ROW)};
#undef STANDOFF_ROW

const FieldFormat& format_of(const std::filesystem::path& path, ErrorCode code) {
  std::string extension = (path.has_filename() ? path : path.parent_path()).extension().string();  // a.zarr/
  if (!extension.empty()) extension.erase(0, 1);
  if (const FieldFormat* format = find_field_format(extension)) return *format;
  std::error_code ignored;
  if (code == ErrorCode::input && std::filesystem::exists(path / "zarr.json", ignored)) return kFieldZarr;
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  std::string known;
  for (const FieldFormat* format : kFieldFormats)
    known += std::string(known.empty() ? "" : ", ") + '.' + format->extension;
  throw Error(code,
              path.string() + ": " +
                  (extension.empty() ? "the name has no extension" : "no field format is called ." + extension) +
                  "; use one of " + known,
              {.file = path.string()});
}

// Lists the formats that can carry what the caller asks for: ".vti or .npz".
std::string those_with(bool FieldFormat::*can) {
  std::string names;
  for (const FieldFormat* format : kFieldFormats)
    if (format->*can) names += (names.empty() ? "." : " or .") + std::string(format->extension);
  return names;
}

FieldFile read_file(const std::filesystem::path& path, const FieldFormat& format, const FieldRequest& request,
                    ProgressMeter& meter) {
  // The file is mapped: a dense file can be larger than memory, while its field is small.
  const FileView file(path, FileView::Access::map, meter);
  if (file.size() == 0) file.fail("the file is empty; write it again");
  return format.read(file, request);
}

FieldFile read(const std::filesystem::path& path, const FieldReadOptions& options, bool sidecars) {
  const FieldFormat& format = format_of(path, ErrorCode::input);
  ProgressMeter meter(options.progress);
  meter.stage("reading", 1, 0, 1);
  const FieldRequest request{memory_limit_of(options.memory_limit), sidecars};
  try {
    FieldFile found =
        format.folder ? format.folder->read(path, request, meter) : read_file(path, format, request, meter);
    meter.stage("done", 1, 1, 1);
    return found;
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::limit, path.string() + ": not enough memory for its samples; provide more memory");
  }
}

void check_options(const std::filesystem::path& path, const FieldFormat& format, const FieldWriteOptions& options) {
  if (options.levels != 1 && !format.folder)
    throw Error(ErrorCode::usage, path.string() + ": ." + format.extension + " has no levels; write ." +
                                      kFieldZarr.extension + ", or leave them out");
  if (options.threads < 0) throw Error(ErrorCode::usage, "threads must be zero or more; give zero for all");
}

// Of all arrays, as numbers.
double bytes_to_write(const FieldSource& source) {
  double bytes = 0;
  for (const SampleArray& array : source.arrays())
    bytes += static_cast<double>(source.grid().sample_count()) * static_cast<double>(array.element_bytes());
  return bytes;
}

void write(const std::filesystem::path& path, const FieldFormat& format, const FieldSource& source,
           const FieldWriteOptions& options) {
  ProgressMeter meter(options.progress);
  meter.stage("writing", 1, 0, 1);
  if (format.folder) return format.folder->write(path, source, options, meter);
  AtomicFile file(path, options.existing);
  if (!format.sparse && !options.compress) expect_room(path, bytes_to_write(source), room_for(path));
  file.watched_by(meter);
  if (!options.sync) file.leave_to_system();
  format.write(file, source, options);
  meter.stage("done", 1, 1, 1);  // nothing stops what follows: the file is there, or there was an error
  file.commit();
}

}  // namespace

const FieldFormat* find_field_format(std::string_view extension) {
  for (const FieldFormat* format : kFieldFormats)
    if (equals_ignoring_case(extension, format->extension)) return format;
  return nullptr;
}

std::vector<FileFormat> field_formats() try {
  std::vector<FileFormat> formats;
  for (const FieldFormat* f : kFieldFormats)
    formats.push_back(
        {f->extension, f->description, true, true, f->nearest, f->sidecars, f->slabs, f->sparse, f->folder != nullptr});
  return formats;
} catch (...) {
  throw_as_error("formats");
}

DistanceField read_field(const std::filesystem::path& path, const FieldReadOptions& options) try {
  return read(path, options, false).field;
} catch (...) {
  throw_as_error("field");
}

FieldFile read_field_file(const std::filesystem::path& path, const FieldReadOptions& options) try {
  return read(path, options, true);
} catch (...) {
  throw_as_error("field");
}

void write_field(const std::filesystem::path& path, const DistanceField& field, const FieldWriteOptions& options) try {
  const FieldFormat& format = format_of(path, ErrorCode::usage);
  const std::string cannot = path.string() + ": ." + format.extension + " cannot carry ";
  if (field.has_nearest() && !format.nearest)
    throw Error(ErrorCode::usage,
                cannot + "nearest triangles; write " + those_with(&FieldFormat::nearest) + ", or compute without them");
  if (!options.sidecars.empty() && !format.sidecars)
    throw Error(ErrorCode::usage, cannot + "sidecars such as " + shown(options.sidecars[0].name) + "; write " +
                                      those_with(&FieldFormat::sidecars) + ", or leave them out");
  check_options(path, format, options);
  check_sidecars(field, options.sidecars);
  write(path, format, FieldSource(field, options.sidecars), options);
} catch (...) {
  throw_as_error("field");
}

void write_field(const std::filesystem::path& path, FieldSlabs& slabs, const FieldWriteOptions& options) try {
  const FieldFormat& format = format_of(path, ErrorCode::usage);
  const std::string cannot = path.string() + ": slab by slab ";
  if (!format.slabs)
    throw Error(ErrorCode::usage, cannot + "no ." + format.extension + " can be written; write " +
                                      those_with(&FieldFormat::slabs) + ", or compute the whole field");
  if (slabs.has_nearest() || !options.sidecars.empty())
    throw Error(ErrorCode::usage, cannot +
                                      "distances alone are written; leave nearest triangles and sidecars out, or "
                                      "compute the whole field");
  check_options(path, format, options);
  validate(slabs.grid());
  write(path, format, FieldSource(slabs), options);
} catch (...) {
  throw_as_error("field");
}

}  // namespace standoff
