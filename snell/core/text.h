// Small helpers for words that people type.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace snell {

// Fewest insertions, deletions, replacements and swaps of neighbouring letters that make b of a (the optimal string
// alignment distance), with ASCII letters compared regardless of case. O(|a| |b|) time.
std::size_t edit_distance(std::string_view a, std::string_view b);

// The candidate that `word` was probably meant to be: the one at the smallest edit distance, if that is at most a third
// of the longer word's length (at least 1), or else the first one that begins with `word`. "" if nothing is near.
std::string nearest(std::string_view word, std::span<const std::string> candidates);

} // namespace snell
