// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>

#include "core/guarded.h"
#include "core/number_text.h"
#include "core/progress.h"
#include "files/array_file.h"
#include "files/text.h"
#include "files/zip.h"
#include "io/mesh/format.h"
#include "standoff/io.h"

namespace standoff {
namespace {

#define STANDOFF_ROW(format) &kMesh##format,
constexpr const MeshFormat* kMeshFormats[] = {STANDOFF_MESH_FORMATS(STANDOFF_ROW)};
#undef STANDOFF_ROW

bool is_called_gz(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return !extension.empty() && equals_ignoring_case(extension, ".gz");
}

// Of x.obj.gz it is OBJ.
const MeshFormat* format_by_extension(const std::filesystem::path& path) {
  const std::string extension = (is_called_gz(path) ? path.stem() : path).extension().string();
  return extension.empty() ? nullptr : find_mesh_format(std::string_view(extension).substr(1));
}

const MeshFormat* format_by_content(std::string_view content) {
  for (const MeshFormat* format : kMeshFormats)
    if (format->recognises(content)) return format;
  return nullptr;
}

template <class Wanted>
std::string extensions(const Wanted& wanted) {
  std::string list;
  for (const MeshFormat* format : kMeshFormats)
    if (wanted(*format)) list += (list.empty() ? "." : ", .") + std::string(format->extension);
  return list;
}

// Text of two bytes a character, in either order: all formats of text are ASCII or UTF-8.
bool is_utf_16(std::string_view content) {
  if (content.size() < 4) return false;
  const bool little = content.starts_with("\xff\xfe"), big = content.starts_with("\xfe\xff");
  return (little && content[3] == '\0') || (big && content[2] == '\0');
}

const MeshFormat& format_to_read(const FileView& file) {
  if (file.bytes().starts_with(kBodyMagic))
    file.fail("byte 0", "the content is a body that standoff build made, and no mesh; rename it to end in .body");
  if (file.bytes().starts_with(kQueryMagic))
    file.fail("byte 0", "the content is a query that standoff build made, and no mesh; rename it to end in .query");
  const MeshFormat* named = format_by_extension(file.path());
  if (is_gzip(file.bytes()) && named && !named->recognises(file.bytes()))
    file.fail("byte 0", "the content is packed by gzip; rename it to end in ." + std::string(named->extension) + ".gz");
  if (is_utf_16(file.bytes()) && !(named && named->recognises(file.bytes())))
    file.fail("byte 0", "the text is UTF-16; save it as UTF-8 or ASCII");
  const MeshFormat* found = named && named->recognises(file.bytes()) ? named : format_by_content(file.bytes());
  if (!named && !found)
    file.fail("", "neither its name nor its content tells a mesh format; give one of " +
                      extensions([](const MeshFormat& f) { return f.read != nullptr; }));
  if (named && found && named != found)
    file.fail("byte 0", "the name says " + std::string(named->name) + " but the content is " + found->name +
                            "; rename it to end in ." + found->extension);
  const MeshFormat& format = named ? *named : *found;
  return format;
}

Mesh read_as(const MeshFormat& format, const FileView& file, MeshReadReport& report) {
  report.format = format.extension;
  Mesh mesh = format.read(file, report);
  report.up = format.up ? *format.up : up_axis(mesh);
  return mesh;
}

// What is packed by gzip, by its name or, where the name says no format, by its content.
Mesh read_any(const FileView& file, MeshReadReport& report) {
  if (file.size() == 0) file.fail("", "the file is empty; check the program that wrote it");
  const bool gz = is_called_gz(file.path());
  if (gz && !is_gzip(file.bytes()))
    file.fail("byte 0", "the name says gzip but the content is not packed; rename it without .gz");
  if (!is_gzip(file.bytes()) || (format_by_extension(file.path()) && !gz))
    return read_as(format_to_read(file), file, report);
  const std::unique_ptr<FileView> unpacked = unpack_gzip(file);
  if (unpacked->size() == 0) file.fail("", "nothing is packed in it; check the program that wrote it");
  // Each packing multiplies what a few bytes become.
  for (const MeshFormat* format : kMeshFormats)
    if (format->packed && format->recognises(unpacked->bytes()))
      file.fail("", "a " + std::string(format->name) +
                        " archive packed by gzip is not read; unpack it (gunzip) and read what comes out");
  report.unpacked = true;
  return read_as(format_to_read(*unpacked), *unpacked, report);
}

void scale_vertices(const FileView& file, Mesh& mesh, double scale) {
  if (scale == 1) return;
  for (Vec3& v : mesh.vertices) v = v * scale;
  for (const Triangle& t : mesh.triangles)
    for (const auto v : t)
      if (!is_finite(mesh.vertices[v]))
        file.fail("vertex " + std::to_string(v), "infinite after scaling; use a smaller scale");
}

}  // namespace

const MeshFormat* find_mesh_format(std::string_view extension) {
  for (const MeshFormat* format : kMeshFormats)
    if (equals_ignoring_case(extension, format->extension)) return format;
  return nullptr;
}

std::vector<FileFormat> mesh_formats() try {
  std::vector<FileFormat> formats;
  for (const MeshFormat* f : kMeshFormats)
    formats.push_back({f->extension, f->description, f->read != nullptr, f->write != nullptr});
  return formats;
} catch (...) {
  throw_as_error("formats");
}

std::vector<std::string> notes(const MeshReadReport& report) try {
  std::vector<std::string> notes;
  if (report.unpacked) notes.push_back("unpacked by gzip");
  if (report.turned()) {
    std::string axes;
    for (const int axis : report.axes) {
      if (axis < -3 || axis == 0 || axis > 3)
        throw Error(ErrorCode::usage,
                    "mesh: a report's axis is " + std::to_string(axis) + "; give 1, 2 or 3, or their negatives");
      axes += std::string(axes.empty() ? "" : ", ") + (axis < 0 ? "-" : "") + "xyz"[std::abs(axis) - 1];
    }
    notes.push_back("axes turned so that y is up: x, y, z are " + axes + " of the file");
  }
  if (report.unit_scale != 1)
    notes.push_back("coordinates multiplied by " + number_text(report.unit_scale) + ", as the file's unit asks for");
  if (report.metres_per_unit > 0)
    notes.push_back(report.metres_per_unit == 1 ? std::string("in metres, as the format says")
                                                : "a unit is " + number_text(report.metres_per_unit) +
                                                      " m, the file says; coordinates are kept in it");
  return notes;
} catch (...) {
  throw_as_error("mesh");
}

MeshReadResult read_mesh(const std::filesystem::path& path, const MeshReadOptions& options) try {
  if (!(std::isfinite(options.scale) && options.scale > 0))
    throw Error(ErrorCode::usage, "scale must be positive and finite; give 0.001 for millimetres to metres");
  try {
    ProgressMeter meter(options.progress);
    meter.stage("reading", 1, 0, 1);
    const FileView file(path, FileView::Access::copy, meter);
    MeshReadResult found;
    found.mesh = read_any(file, found.report);
    scale_vertices(file, found.mesh, options.scale);
    meter.stage("done", 1, 1, 1);
    return found;
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::limit, path.string() + ": not enough memory for its triangles; provide more memory");
  }
} catch (...) {
  throw_as_error("mesh");
}

void write_mesh(const std::filesystem::path& path, MeshView mesh, const MeshWriteOptions& options) try {
  const MeshFormat* format = is_called_gz(path) ? nullptr : format_by_extension(path);
  if (!format || !format->write)
    throw Error(ErrorCode::usage, path.string() + ": no mesh format to write goes by this extension; use one of " +
                                      extensions([](const MeshFormat& f) { return f.write != nullptr; }));
  validate(mesh);
  if (!(std::isfinite(options.metres_per_unit) && options.metres_per_unit >= 0))
    throw Error(ErrorCode::usage,
                path.string() + ": metres per unit must be finite and not negative; give 0 where they are unknown");
  ProgressMeter meter(options.progress);
  meter.stage("writing", 1, 0, 1);
  AtomicFile file(path, options.existing);
  file.watched_by(meter);
  format->write(file, mesh, options);
  meter.stage("done", 1, 1, 1);  // nothing stops what follows: the file is there, or there was an error
  file.commit();
} catch (...) {
  throw_as_error("mesh");
}

}  // namespace standoff
