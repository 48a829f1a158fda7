// edit/stroke_file.h: strokes as text that people write and read (docs/sculpting.md has the words):
//
//   sdfgrid-strokes: 1
//   strokes:
//     - {op: union, brush: {sphere: {radius: 0.05}}, path: [[0, 0, 1], [0.2, 0, 1]]}
#pragma once

#include <string>
#include <vector>

#include "sdfgrid/edit/stamp.h"
#include "sdfgrid/edit/stroke.h"

namespace sdfgrid {

struct StrokeWarning {
  enum class Kind {
    unknown_word,  // that was left out
    no_effect,     // of a word that its stroke has no use for
  };
  Kind kind;
  std::string text;  // with file and line
};

struct StrokeFile {
  std::vector<Stroke> strokes;  // each with its text and its line
  std::vector<StrokeWarning> warnings;
};

// Throws Error{input} with file, line and remedy for what is not such a file, and for a stroke
// without op, brush or path or with a value of the wrong kind. Stamps are relative to its folder.
[[nodiscard]] StrokeFile read_strokes(const std::string& path, StampMaker* stamps = nullptr);

// The same of text; `source` is what messages call it.
[[nodiscard]] StrokeFile parse_strokes(const std::string& text, const std::string& source,
                                       const StampSource& stamps = {});

// One stroke from Stroke::text.
[[nodiscard]] Stroke parse_stroke(const std::string& text, const std::string& source,
                                  const StampSource& stamps = {});

// The text with other names for its stamps' files, one for each of Stroke::stamps.
[[nodiscard]] std::string with_stamp_files(const std::string& text,
                                           const std::vector<std::string>& files);

}  // namespace sdfgrid
