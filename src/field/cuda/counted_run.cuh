// A field for somebody who can wait: what is needed is counted, the host looks, makes just that room, and the work goes
// on. Nothing is guessed, so nothing is done twice; what it costs is a wait per level of the descent, or one in all.
#pragma once

#include "field/cuda/enqueue.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Device memory that is made anew where it is too small. What it held is lost then.
class Growing {
 public:
  /// Room for `count` of them. Throws Error{limit}.
  template <class T>
  T* room_for(std::int64_t count) {
    const std::int64_t bytes = count * static_cast<std::int64_t>(sizeof(T));
    if (bytes > bytes_) {
      memory_ = Memory();  // the old before the new; cudaFree waits for what still reads it
      bytes_ = 0;
      memory_ = Memory(bytes);
      bytes_ = bytes;
    }
    return memory_.as<T>();
  }

 private:
  Memory memory_;
  std::int64_t bytes_ = 0;
};

/// Bytes that a CountedRun takes from its beginning on; lists and values come to them when they have been counted.
inline std::int64_t counting_bytes(std::int64_t triangles, const Grid& grid, double thickness, Method method) {
  const Lattice l = make_lattice(grid, thickness);
  return with_way(method, grid, thickness, [&]<class Arrays>(auto) {
    gpu::Workspace memory(nullptr);
    const Arrays arrays(memory, triangles, l, 0);
    return memory.used() + l.tile_count() * static_cast<std::int64_t>(sizeof(std::int32_t));
  });
}

/// One sparse field, on the default stream.
class CountedRun {
 public:
  /// The mesh is in device memory, and was validated. `waited` is called after each look at the counts.
  template <class Waited>
  CountedRun(const DeviceMesh& mesh, const Grid& grid, double thickness, Method method, bool with_nearest,
             Waited waited)
      : l_(make_lattice(grid, thickness)), with_nearest_(with_nearest), outcome_memory_(sizeof(Outcome)) {
    check_count(mesh);
    const std::int64_t tiles = l_.tile_count();
    task_ = {mesh, grid, thickness, method, {}, outcome_memory_.as<Outcome>()};
    task_.output.slots = slots_.room_for<std::int32_t>(tiles);
    task_.output.slot_capacity = tiles;  // no values yet: all may have a slot
    with_way(method, grid, thickness, [&]<class Arrays>(auto) {
      gpu::Workspace measure(nullptr);
      const Arrays sizes(measure, mesh.used_count(), l_, 0);
      const Memory bare(measure.used());
      gpu::Workspace memory(bare.as<void>());
      Arrays arrays(memory, mesh.used_count(), l_, 0);
      run(arrays, waited);
      look();  // before the arrays go
    });
  }

  const Outcome& outcome() const { return outcome_; }
  /// Tiles that turned out to hold no sample of the band have no slot any more; the values of theirs are zero.
  const DeviceOutput& output() const { return task_.output; }

 private:
  template <class Waited>
  void run(ThinArrays& a, Waited waited) {
    a.lists.capacity = ~Counter{0};
    count_thin(l_, task_, a, nullptr);
    look();
    waited();
    a.lists.capacity = outcome_.needed_entries;
    expect_room(static_cast<std::int64_t>(outcome_.needed_entries) * ThinArrays::kBytesPerEntry + value_bytes());
    a.lists.entries = entries_[0].room_for<std::uint32_t>(static_cast<std::int64_t>(outcome_.needed_entries));
    make_values();
    fill_thin(l_, task_, a, nullptr);
  }

  template <class Waited>
  void run(ThickArrays& a, Waited waited) {
    std::int64_t most = task_.mesh.used_count();  // candidates of any level so far
    expect_room(most * ThickArrays::kBytesPerEntry);
    a.capacity = ~Counter{0};
    a.entries[0] = entries_[0].room_for<std::uint32_t>(most);
    begin_thick(task_, a, nullptr);
    int half = 0;
    for (int number = gpu::top_level(l_); number > 0; --number, half = 1 - half) {
      a.keep = keep_.room_for<unsigned char>(most);
      Descent level(l_, a, number - 1, half);
      count_level(l_, task_, a, level, nullptr);
      look();
      waited();
      most = std::max(most, static_cast<std::int64_t>(outcome_.needed_entries));
      level.step.child_entries = a.entries[1 - half] = entries_[1 - half].room_for<std::uint32_t>(most);
      fill_level(l_, task_, level, nullptr);
    }
    a.tiles.give(l_, task_, a.start[half], nullptr);
    look();
    keep_ = Growing();  // the tiles' lists alone are still needed
    entries_[1 - half] = Growing();
    expect_room(value_bytes());
    make_values();
    gather_thick(l_, task_, a, half, nullptr);
  }

  template <class Waited>
  void run(ThesisArrays& a, Waited waited) {
    lower_thesis(l_, task_, a, nullptr);
    look();
    waited();
    expect_room(value_bytes());
    make_values();
    write_thesis(l_, task_, a, nullptr);
  }

  /// Waits for the device.
  void look() {
    copy_out(&outcome_, task_.outcome, sizeof outcome_);
    if (outcome_.stopped != 0)
      throw Error(ErrorCode::internal, "gpu: the kernels stopped without a reason; please report this");
  }

  std::int64_t value_count() const { return static_cast<std::int64_t>(outcome_.needed_slots) * kTileSamples; }
  std::int64_t value_bytes() const { return (with_nearest_ ? 8 : 4) * value_count(); }

  // Tiles are copied out many at a time, also those that will have lost their slot: so none may be left unwritten.
  void make_values() {
    task_.output.slot_capacity = static_cast<std::int64_t>(outcome_.needed_slots);
    if (task_.output.slot_capacity == 0) return;
    task_.output.values = values_.room_for<float>(value_count());
    fill_bytes(nullptr, task_.output.values, 0, 4 * value_count());
    if (!with_nearest_) return;
    task_.output.nearest = nearest_.room_for<std::uint32_t>(value_count());
    fill_bytes(nullptr, task_.output.nearest, 0, 4 * value_count());
  }

  Lattice l_;
  bool with_nearest_;
  Task task_;
  Outcome outcome_{};
  Memory outcome_memory_;
  Growing slots_, values_, nearest_, entries_[2], keep_;
};

}  // namespace standoff::STANDOFF_PLATFORM
