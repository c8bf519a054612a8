// SPDX-License-Identifier: Apache-2.0
// What somebody may have meant who wrote a word that is none of those there are.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace standoff::cli {

/// The fewest steps that turn one word into the other, where a step inserts, removes or replaces one letter, or swaps
/// two neighbours, and no letter changes twice. Capitals count as small letters.
std::size_t edits(std::string_view a, std::string_view b);

/// Which of the words somebody may have meant, the nearest first, and of those equally near the earlier first: those
/// that begin with what was written, and those within a third of its letters in edits. Dashes before a word are no
/// letters. Returns none where more than three are near: then none is.
std::vector<std::size_t> meant(std::string_view written, const std::vector<std::string>& words);

/// "; did you mean 'X'?" or "; did you mean 'X' or 'Y'?" or nothing.
std::string did_you_mean(std::string_view written, const std::vector<std::string>& words);
/// The same of names that were found already.
std::string did_you_mean(const std::vector<std::string>& names);

}  // namespace standoff::cli
