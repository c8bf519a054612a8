// SPDX-License-Identifier: Apache-2.0
// Points from NumPy arrays (.npy, and one array of an .npz archive: shape (n, 3), float32 or float64, any byte order
// and either order of axes) and from PLY.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "files/file_view.h"
#include "files/zip.h"
#include "io/field/npy.h"
#include "io/mesh/ply_data.h"
#include "io/points/points.h"

namespace standoff {
namespace {

template <class Stored>
double value_at(const char* place, bool swapped) {
  std::array<char, sizeof(Stored)> bytes;
  std::memcpy(bytes.data(), place, sizeof(Stored));
  if (swapped) std::reverse(bytes.begin(), bytes.end());
  return static_cast<double>(std::bit_cast<Stored>(bytes));
}

constexpr std::uint64_t kPointsPart = std::uint64_t{1} << 20;  // bytes that are passed over at once

class ArrayPoints : public PointReader {
 public:
  ArrayPoints(std::unique_ptr<FileView> file, InvalidPoints invalid) : file_(std::move(file)), invalid_(invalid) {}

  void open_npy() {
    const std::string_view bytes = file_->bytes();
    set(read_npy(*file_, "header", bytes.substr(0, kMaxNpyHeader), bytes.size()),
        [bytes] { return std::make_unique<BytesInMemory>(bytes); });
  }

  void open_npz() {
    members_ = read_zip(*file_);
    const ZipMember& member = choose();
    name_ = shown(member.name) + ": ";
    const std::string start(ZipMemberStream(*file_, member).next(std::min(member.bytes, kMaxNpyHeader)));
    set(read_npy(*file_, member.name, start, member.bytes),
        [this, &member] { return std::make_unique<ZipMemberStream>(*file_, member); });
  }

  std::size_t read(std::span<Vec3> points) override {
    const std::uint64_t todo = std::min<std::uint64_t>(points.size(), count_ - done_);
    for (std::uint64_t n = 0; n < todo;) {
      const std::uint64_t part = std::min(todo - n, kPointsPart / (3 * width_));
      take(points.subspan(n, part));
      n += part;
    }
    if (done_ == count_ && !finished_) {
      streams_[0]->finish();
      finished_ = true;
    }
    return todo;
  }
  std::optional<std::uint64_t> count() const override { return count_; }
  double fraction() const override { return count_ > 0 ? static_cast<double>(done_) / static_cast<double>(count_) : 1; }

 private:
  // The array `points`, or the only one.
  const ZipMember& choose() const {
    for (const ZipMember& member : members_)
      if (member.name == "points.npy") return member;
    if (members_.size() != 1)
      file_->fail("it has " + std::to_string(members_.size()) + " arrays, none of them called points; rename one");
    return members_[0];
  }

  template <class Open>
  void set(const NpyArray& array, const Open& open) {
    const auto fail = [&](const std::string& what) { file_->fail(name_ + what); };
    swapped_ = array.type.starts_with('>');
    if (array.type.size() != 3 || !(swapped_ || array.type.starts_with('<')) ||
        !(array.type.ends_with("f4") || array.type.ends_with("f8")))
      fail("its type is " + in_quotes(array.type) + "; save points as float64 or float32");
    width_ = array.type.ends_with("f4") ? 4 : 8;
    if (array.shape.size() != 2 || array.shape[1] != 3) {
      std::string shape;
      for (const auto side : array.shape) shape += (shape.empty() ? "" : ", ") + std::to_string(side);
      fail("its shape is (" + shown(shape) + "); points have the shape (n, 3)");
    }
    count_ = static_cast<std::uint64_t>(array.shape[0]);
    if (count_ > array.bytes / (3 * width_))
      fail("its shape promises " + std::to_string(count_) +
           " points, more than the file can hold; it is cut off or damaged, get all of it");
    fortran_ = array.fortran_order;
    for (std::size_t axis = 0; axis < (fortran_ ? 3u : 1u); ++axis) {
      streams_[axis] = open();
      std::uint64_t before = array.offset + axis * count_ * width_;
      for (std::uint64_t part; before > 0; before -= part) streams_[axis]->next(part = std::min(before, kPointsPart));
    }
  }

  // The next points, all of which there are.
  void take(std::span<Vec3> points) {
    std::array<std::string_view, 3> bytes;
    const std::uint64_t step = fortran_ ? width_ : 3 * width_;
    for (std::size_t axis = 0; axis < 3; ++axis)
      bytes[axis] = fortran_    ? streams_[axis]->next(points.size() * step)
                    : axis == 0 ? streams_[0]->next(points.size() * step)
                                : bytes[0].substr(axis * width_);
    for (std::size_t n = 0; n < points.size(); ++n, ++done_) {
      const auto value = [&](std::size_t axis) {
        const char* place = bytes[axis].data() + n * step;
        return width_ == 4 ? value_at<float>(place, swapped_) : value_at<double>(place, swapped_);
      };
      points[n] = {value(0), value(1), value(2)};
      if (!check_point(points[n], invalid_) && invalid_ == InvalidPoints::reject)
        file_->fail("point " + std::to_string(done_), name_ + invalid_point(done_, points[n]));
    }
    for (const std::string_view part : bytes) file_->forget(part);
  }

  std::unique_ptr<FileView> file_;
  InvalidPoints invalid_;
  std::vector<ZipMember> members_;
  std::string name_;                                    // of the member, for messages
  std::array<std::unique_ptr<ByteStream>, 3> streams_;  // one per axis, or one for all
  bool fortran_ = false, swapped_ = false, finished_ = false;
  std::uint64_t width_ = 8, count_ = 0, done_ = 0;
};

}  // namespace

std::unique_ptr<PointReader> npy_points(std::unique_ptr<FileView> file, InvalidPoints invalid) {
  auto points = std::make_unique<ArrayPoints>(std::move(file), invalid);
  points->open_npy();
  return points;
}

std::unique_ptr<PointReader> npz_points(std::unique_ptr<FileView> file, InvalidPoints invalid) {
  auto points = std::make_unique<ArrayPoints>(std::move(file), invalid);
  points->open_npz();
  return points;
}

// PLY: the vertices of a point cloud or mesh, as they stand there; all else is passed over.

namespace {

template <class Body>
class PlyPoints : public PointReader {
 public:
  PlyPoints(std::unique_ptr<FileView> file, PlyHeader header, InvalidPoints invalid)
      : file_(std::move(file)),
        header_(std::move(header)),
        row_{*file_},
        body_(*file_, header_, row_),
        invalid_(invalid) {
    for (const PlyElement& element : header_.elements) {
      row_.element = &element;
      if (element.name == "vertex") break;
      row_.element = nullptr;
    }
    if (!row_.element)
      file_->fail("header", "there are no vertices, which would be the points; write the file again with them");
    axes_ = position_axes(*file_, *row_.element);
    distance_ = row_.element->find("distance");
    if (distance_ >= 0 && row_.element->properties[static_cast<std::size_t>(distance_)].list) distance_ = -1;
    pass_over_what_is_before(*row_.element);
    check_count(*file_, *row_.element, body_);
  }

  std::size_t read(std::span<Vec3> points) override {
    std::size_t n = 0;
    distances_.clear();
    for (; n < points.size() && row_.number < row_.element->count; ++n, ++row_.number) {
      double distance = 0;
      points[n] = read_position(body_, row_, axes_, distance_, &distance);
      if (distance_ >= 0) distances_.push_back(distance);
      if (!check_point(points[n], invalid_) && invalid_ == InvalidPoints::reject)
        file_->fail("vertex " + std::to_string(row_.number), invalid_point(row_.number, points[n]));
    }
    const std::uint64_t end = file_->size() - body_.bytes_left();
    file_->forget(file_->text(forgotten_, end - forgotten_));
    forgotten_ = end;
    return n;
  }
  std::optional<std::uint64_t> count() const override { return row_.element->count; }
  double fraction() const override {
    const std::uint64_t all = row_.element->count;
    return all > 0 ? static_cast<double>(row_.number) / static_cast<double>(all) : 1;
  }

 private:
  void pass_over_what_is_before(const PlyElement& vertices) {
    for (const PlyElement& element : header_.elements) {
      row_.element = &element;
      row_.number = 0;
      if (&element == &vertices) return;
      check_count(*file_, element, body_);
      if (element.least_bytes(Body::kAscii) == 0) continue;  // rows without content, however many
      for (; row_.number < element.count; ++row_.number) {
        for (const PlyProperty& property : element.properties) skip_property(body_, row_, property);
        body_.end_row();
      }
    }
  }

  std::unique_ptr<FileView> file_;
  PlyHeader header_;
  PlyRow row_;
  Body body_;
  std::array<int, 3> axes_{};
  int distance_ = -1;  // the property of that name
  InvalidPoints invalid_;
  std::uint64_t forgotten_ = 0;
};

}  // namespace

std::unique_ptr<PointReader> ply_points(std::unique_ptr<FileView> file, InvalidPoints invalid) {
  PlyHeader header = read_ply_header(*file);
  switch (header.encoding) {
    case PlyHeader::Encoding::little_endian:
      return std::make_unique<PlyPoints<PlyBinaryBody<false>>>(std::move(file), std::move(header), invalid);
    case PlyHeader::Encoding::big_endian:
      return std::make_unique<PlyPoints<PlyBinaryBody<true>>>(std::move(file), std::move(header), invalid);
    case PlyHeader::Encoding::ascii:
      break;
  }
  return std::make_unique<PlyPoints<PlyAsciiBody>>(std::move(file), std::move(header), invalid);
}

}  // namespace standoff
