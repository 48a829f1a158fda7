// edit/stroke_words.h: the words of stroke files: which there are, which of them an op has no use
// for, and what a mistyped one was meant to be. Internal to edit/.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sdfgrid/edit/stroke.h"

namespace sdfgrid {

inline constexpr const char* kStampWord = "stamp";  // a union at the path's points alone

// What may stand in a stroke; after `op`, `stamp` among them; and as the op of a brush.
[[nodiscard]] std::vector<std::string> words_of_stroke();
[[nodiscard]] std::vector<std::string> words_of_op();
[[nodiscard]] std::vector<std::string> words_of_brush();

// "did you mean 'WORD'? ", or "" where none of them is near.
[[nodiscard]] std::string meant(std::string_view given, const std::vector<std::string>& words);
[[nodiscard]] std::string joined(const std::vector<std::string>& words);  // with commas

// Why the stroke does nothing with one of its words, as part of a sentence; "" if it does. The
// spacing of a swept ball counts the dabs that are reported.
[[nodiscard]] std::string why_unused(const Stroke& stroke, std::string_view word);

}  // namespace sdfgrid
