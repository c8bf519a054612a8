// SPDX-License-Identifier: Apache-2.0
// Counts the bytes a program holds, whoever asks for them: standoff, the standard library.
#pragma once

#include <cstddef>

namespace standoff::grammar {

/// From now on, until the next call: past `most` bytes more than are held now, `past` is called, and must not return.
/// Nothing is counted under sanitizers, which have an allocator of their own.
void watch_memory(std::size_t most, void (*past)());

/// The most that was held since then, in bytes; from now on there is no bound.
std::size_t peak_memory();

}  // namespace standoff::grammar
