#include "sdfgrid/edit/stroke_words.h"

#include <fmt/format.h>

#include "sdfgrid/core/words.h"
#include "sdfgrid/field/field.h"

namespace sdfgrid {

std::vector<std::string> words_of_stroke() {
  return {"op", "brush", "path", "spacing", "smooth", "strength", "material", "mirror", "name"};
}

std::vector<std::string> words_of_op() {
  std::vector<std::string> words;
  for (int i = 0; i <= static_cast<int>(StrokeOp::paint); ++i) {
    words.emplace_back(stroke_op_word(static_cast<StrokeOp>(i)));
  }
  words.emplace_back(kStampWord);
  return words;
}

std::vector<std::string> words_of_brush() {
  std::vector<std::string> words = {"grid", "scene"};
  for (const OpEntry& entry : op_list()) words.emplace_back(entry.info->name);
  return words;
}

std::string meant(std::string_view given, const std::vector<std::string>& words) {
  const std::string near = nearest_word(given, words);
  return near.empty() ? "" : fmt::format("did you mean '{}'? ", near);
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string why_unused(const Stroke& stroke, std::string_view word) {
  const bool clay = !is_csg(stroke.op) && stroke.op != StrokeOp::paint;
  if (word == "spacing" && stroke.at_points) return "a stamp is put down at the path's points";
  if (word == "smooth" && !is_csg(stroke.op)) {
    return "only union, difference and intersection blend";
  }
  if (word == "strength" && !clay) return "only the clay tools have a strength";
  if (word == "material" && stroke.op != StrokeOp::paint) return "only paint gives a material";
  return "";
}

}  // namespace sdfgrid
