// SPDX-License-Identifier: Apache-2.0
#include "io/field/send_samples.h"

#include <tbb/parallel_pipeline.h>

#include <optional>

#include "core/per_thread.h"
#include "core/threads.h"
#include "files/run_deflate.h"

namespace standoff {
namespace {

constexpr std::int64_t kBlockBytes = std::int64_t{1} << 20;

// Elements as they are.
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

struct Block {
  std::int64_t begin = 0, end = 0;
  std::string bytes;
  std::uint32_t checksum = 0;
};

}  // namespace

void send_samples(const DistanceField& field, const SampleArray& array, const ArrayPart& part, const ByteSink& sink) {
  const std::int64_t step = block_elements(array, part), all = field.grid().sample_count();
  Plain plain(part.element_bytes(array));
  for (std::int64_t begin = 0; begin < all; begin += step) {
    plain.clear();
    send_elements(field, array, part, begin, std::min(all, begin + step), plain);
    sink(plain.bytes());
  }
}

std::int64_t block_elements(const SampleArray& array, const ArrayPart& part) {
  return kBlockBytes / static_cast<std::int64_t>(part.element_bytes(array));
}

void pack_samples(const DistanceField& field, const SampleArray& array, const ArrayPart& part,
                  const PackOptions& options, const std::function<void(const PackedBlock&)>& take) {
  const std::int64_t step = block_elements(array, part), all = field.grid().sample_count();
  const std::size_t element_bytes = part.element_bytes(array);
  std::optional<CrcRuns> runs;
  if (options.kind == BlockKind::deflate) {
    const std::string unstored[] = {unstored_element(array, part, false), unstored_element(array, part, true)};
    runs.emplace(unstored, static_cast<std::uint64_t>(step));
  }
  std::int64_t begin = 0;
  PackedBlock done{{}, options.crc};
  Threads threads(options.threads);
  threads.run([&] {
    PerThread<RunDeflater> deflaters([&] { return RunDeflater(element_bytes); });
    const auto next = [&](tbb::flow_control& control) {
      if (begin >= all) {
        control.stop();
        return Block{};
      }
      Block block{begin, std::min(all, begin + step), {}, 0};
      begin = block.end;
      return block;
    };
    const auto pack = [&](Block block) {
      RunDeflater& deflater = deflaters.local();
      deflater.clear();
      send_elements(field, array, part, block.begin, block.end, deflater);
      if (runs) {
        deflater.deflate(block.bytes, RunDeflater::End::more);
        block.checksum = deflater.crc32(*runs);
      } else {
        block.bytes = deflater.zlib();
      }
      return block;
    };
    const auto hand_over = [&](Block block) {
      done.bytes = std::move(block.bytes);
      if (runs) done.crc = runs->joined(done.crc, block.checksum, static_cast<std::uint64_t>(block.end - block.begin));
      take(done);
    };
    tbb::parallel_pipeline(4 * static_cast<std::size_t>(threads.count()),
                           tbb::make_filter<void, Block>(tbb::filter_mode::serial_in_order, next) &
                               tbb::make_filter<Block, Block>(tbb::filter_mode::parallel, pack) &
                               tbb::make_filter<Block, void>(tbb::filter_mode::serial_in_order, hand_over));
  });
}

}  // namespace standoff
