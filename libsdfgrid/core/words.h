// core/words.h: the answer to a mistyped word.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sdfgrid {

// The fewest insertions, deletions, substitutions and swaps of neighbours that turn a into b.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

// The word nearest to `given`, or "" if none is near enough to be what was meant: a third of its
// letters may differ, and always one or two.
[[nodiscard]] std::string nearest_word(std::string_view given,
                                       const std::vector<std::string>& words);

}  // namespace sdfgrid
