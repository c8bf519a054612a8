// SPDX-License-Identifier: Apache-2.0
#include "io/field/write_samples.h"

#include <bit>
#include <optional>
#include <set>
#include <string>

#include <tbb/parallel_pipeline.h>

#include "core/guarded.h"
#include "core/threads.h"
#include "files/deflate.h"
#include "standoff/error.h"

namespace standoff {
namespace {

static_assert(std::endian::native == std::endian::little, "field files are written as the machine holds numbers");

template <class Number>
std::array<std::byte, 4> bytes_of_number(Number number) {
  return std::bit_cast<std::array<std::byte, 4>>(number);
}

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= 100 && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

}  // namespace

SampleArray distance_array(const DistanceField& field) {
  return distance_array(field.thickness(), reinterpret_cast<const std::byte*>(field.tile_values().data()));
}

SampleArray distance_array(double thickness, const std::byte* values) {
  const auto far = static_cast<float>(thickness);
  return {"distance", NumberType::float32, 1, values, bytes_of_number(far), bytes_of_number(-far)};
}

std::vector<SampleArray> arrays_of(const DistanceField& field, std::span<const Sidecar> sidecars) {
  std::vector<SampleArray> arrays{distance_array(field)};
  const auto none = bytes_of_number(kNoTriangle);
  if (field.has_nearest())
    arrays.push_back({"nearest_triangle", NumberType::uint32, 1,
                      reinterpret_cast<const std::byte*>(field.tile_nearest_values().data()), none, none});
  for (const Sidecar& sidecar : sidecars) {
    const bool floats = std::holds_alternative<std::vector<float>>(sidecar.values);
    const std::byte* values =
        std::visit([](const auto& v) { return reinterpret_cast<const std::byte*>(v.data()); }, sidecar.values);
    arrays.push_back(
        {sidecar.name, floats ? NumberType::float32 : NumberType::uint8, sidecar.components, values, {}, {}});
  }
  return arrays;
}

std::set<std::string> reserved_names() {
  return {"distance", "nearest_triangle", "origin",  "spacing", "thickness",
          "method",   "mesh_hash",        "version", "sign",    "up"};
}

void check_sidecars(const DistanceField& field, std::span<const Sidecar> sidecars) {
  std::set<std::string> names = reserved_names();
  for (const Sidecar& sidecar : sidecars) {
    const auto fail = [&](const std::string& what) {
      throw Error(ErrorCode::usage, "sidecar '" + sidecar.name.substr(0, 40) + "': " + what);
    };
    if (!is_name(sidecar.name)) fail("its name is not made of letters, digits and underscores; give it another one");
    if (!names.insert(sidecar.name).second) fail("its name is taken; give it another one");
    if (sidecar.components < 1 || sidecar.components > kMostComponents)
      fail("it has " + std::to_string(sidecar.components) + " numbers per sample; give 1 to " +
           std::to_string(kMostComponents));
    const auto wanted = static_cast<std::uint64_t>(field.stored_tiles()) * DistanceField::kTileSamples *
                        static_cast<std::uint64_t>(sidecar.components);
    const std::uint64_t found = std::visit([](const auto& v) { return std::uint64_t{v.size()}; }, sidecar.values);
    if (found != wanted)
      fail("it has " + std::to_string(found) + " numbers, where the field's stored tiles need " +
           std::to_string(wanted) + "; give those of this field");
  }
}

std::string unstored_element(const SampleArray& array, const ArrayPart& part, bool inside) {
  const std::array<std::byte, 4>& number = inside ? array.inside : array.outside;
  std::string element;
  for (int n = part.component ? 1 : array.components; n > 0; --n)
    element.append(reinterpret_cast<const char*>(number.data()), array.number_bytes());
  return element;
}

FieldSource::FieldSource(const DistanceField& field, std::span<const Sidecar> sidecars)
    : grid_(field.grid()),
      thickness_(field.thickness()),
      provenance_(field.provenance()),
      whole_(&field),
      arrays_(arrays_of(field, sidecars)) {}

FieldSource::FieldSource(FieldSlabs& slabs)
    : grid_(slabs.grid()),
      thickness_(slabs.thickness()),
      provenance_(slabs.provenance()),
      slabs_(&slabs),
      arrays_{distance_array(thickness_, nullptr)} {}

const DistanceField* FieldSource::next_slab(std::int64_t slices_before) const {
  const auto fail = [](const std::string& what) {
    throw Error(ErrorCode::usage, "a field in slabs: " + what + "; give slabs that make up its grid");
  };
  const DistanceField* const slab = call_back([&] { return slabs_->next(); });
  const std::int64_t slices = slices_before + (slab ? slab->grid().size.z : 0);
  if (slab && (slab->grid().size.x != grid_.size.x || slab->grid().size.y != grid_.size.y))
    fail("the slices of a slab are not as large as those of the grid");
  if (slab && static_cast<float>(slab->thickness()) != static_cast<float>(thickness_))
    fail("a slab has a thickness of its own");
  if (slices > grid_.size.z || (!slab && slices != grid_.size.z))
    fail("its slabs have " + std::to_string(slices) + (slab ? " slices or more" : " slices") + ", where the grid has " +
         std::to_string(grid_.size.z));
  return slab;
}

namespace {

constexpr std::int64_t kBlockBytes = std::int64_t{1} << 20;

// Collects elements as they are.
class Plain {
 public:
  explicit Plain(std::size_t element_bytes) : element_bytes_(element_bytes) {}

  void elements(const std::byte* from, std::uint64_t count) {
    bytes_.insert(bytes_.end(), from, from + count * element_bytes_);
  }
  void run(const std::byte* element, std::uint64_t count) {
    for (; count > 0; --count) bytes_.insert(bytes_.end(), element, element + element_bytes_);
  }
  std::span<const std::byte> bytes() const { return bytes_; }
  void clear() { bytes_.clear(); }

 private:
  std::size_t element_bytes_;
  std::vector<std::byte> bytes_;
};

// Packs the parts of an array one after the other. Blocks do not end where parts do: one that goes on in the next part
// stays open until then.
class Packing {
 public:
  Packing(const FieldSource& source, const SampleArray& array, const ArrayPart& part, const PackOptions& options,
          const std::function<void(const PackedBlock&)>& take)
      : part_(part),
        step_(block_elements(array, part)),
        all_(source.grid().sample_count()),
        take_(take),
        done_{{}, options.crc},
        open_(part.element_bytes(array)),
        threads_(options.threads) {
    if (options.kind == BlockKind::deflate) runs_.emplace(part.element_bytes(array), static_cast<std::uint64_t>(step_));
    threads_.run([&] { deflaters_.emplace([bytes = part.element_bytes(array)] { return RunDeflater(bytes); }); });
  }

  void add(const DistanceField& field, const SampleArray& array, std::int64_t first) {
    const std::int64_t end = field.grid().sample_count();
    const bool is_last = first + end == all_;
    std::int64_t begin = 0;
    if (opened_ != 0) {
      begin = std::min(step_ - opened_, end);
      open(field, array, 0, begin);
      if (opened_ < step_ && !is_last) return;
      hand_over(packed(open_, opened_));
      open_.clear();
      opened_ = 0;
    }
    const std::int64_t stop = is_last ? end : begin + (end - begin) / step_ * step_;
    threads_.run([&] { pack(field, array, begin, stop); });
    if (stop < end) open(field, array, stop, end);
  }

 private:
  struct Range {
    std::int64_t begin = 0, end = 0;
  };
  struct Block {
    std::string bytes;
    std::uint32_t checksum = 0;
    std::int64_t elements = 0;
  };

  void open(const DistanceField& field, const SampleArray& array, std::int64_t begin, std::int64_t end) {
    send_elements(field, array, part_, begin, end, open_);
    opened_ += end - begin;
  }

  void pack(const DistanceField& field, const SampleArray& array, std::int64_t begin, std::int64_t end) {
    const auto next = [&](tbb::flow_control& control) {
      if (begin >= end) {
        control.stop();
        return Range{};
      }
      const Range range{begin, std::min(end, begin + step_)};
      begin = range.end;
      return range;
    };
    const auto pack = [&](const Range& range) {
      RunDeflater& deflater = deflaters_->local();
      deflater.clear();
      send_elements(field, array, part_, range.begin, range.end, deflater);
      return packed(deflater, range.end - range.begin);
    };
    tbb::parallel_pipeline(
        4 * static_cast<std::size_t>(threads_.count()),
        tbb::make_filter<void, Range>(tbb::filter_mode::serial_in_order, next) &
            tbb::make_filter<Range, Block>(tbb::filter_mode::parallel, pack) &
            tbb::make_filter<Block, void>(tbb::filter_mode::serial_in_order, [&](Block block) { hand_over(block); }));
  }

  Block packed(const RunDeflater& deflater, std::int64_t elements) const {
    Block block{{}, 0, elements};
    if (runs_) {
      deflater.deflate(block.bytes, RunDeflater::End::more);
      block.checksum = deflater.crc32(*runs_);
    } else {
      block.bytes = deflater.zlib();
    }
    return block;
  }

  void hand_over(Block block) {
    done_.bytes = std::move(block.bytes);
    if (runs_) done_.crc = runs_->joined(done_.crc, block.checksum, static_cast<std::uint64_t>(block.elements));
    take_(done_);
  }

  ArrayPart part_;
  std::int64_t step_, all_;
  const std::function<void(const PackedBlock&)>& take_;
  std::optional<CrcRuns> runs_;
  PackedBlock done_;
  RunDeflater open_;  // the block that goes on in the next part
  std::int64_t opened_ = 0;
  Threads threads_;
  std::optional<PerThread<RunDeflater>> deflaters_;
};

}  // namespace

void send_samples(const FieldSource& source, const SampleArray& array, const ArrayPart& part, const ByteSink& sink) {
  const std::int64_t step = block_elements(array, part);
  Plain plain(part.element_bytes(array));
  source.for_each_part(array, [&](const DistanceField& field, const SampleArray& here, std::int64_t) {
    const std::int64_t all = field.grid().sample_count();
    for (std::int64_t begin = 0; begin < all; begin += step) {
      plain.clear();
      send_elements(field, here, part, begin, std::min(all, begin + step), plain);
      sink(plain.bytes());
    }
  });
}

std::int64_t block_elements(const SampleArray& array, const ArrayPart& part) {
  return kBlockBytes / static_cast<std::int64_t>(part.element_bytes(array));
}

void pack_samples(const FieldSource& source, const SampleArray& array, const ArrayPart& part,
                  const PackOptions& options, const std::function<void(const PackedBlock&)>& take) {
  Packing packing(source, array, part, options, take);
  source.for_each_part(array, [&](const DistanceField& field, const SampleArray& here, std::int64_t first) {
    packing.add(field, here, first);
  });
}

}  // namespace standoff
