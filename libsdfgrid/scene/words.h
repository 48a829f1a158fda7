// scene/words.h: the words of scene files, also those that are no ops of field/.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sdfgrid/field/field.h"

namespace sdfgrid {

inline constexpr int kMeshDim = 256;  // of `mesh`: voxels along its longest side, if not said

// What a word that makes a node takes.
struct NodeWord {
  std::vector<std::string> numbers;  // names of its parameters that are numbers
  std::vector<std::string> texts;    // of those that are texts
  bool leaf = false;
  std::vector<std::string> endless;  // of the numbers: which may be infinite
};

// `grid`, `mesh` and `displace`, as the ops of op_list() say it of themselves.
[[nodiscard]] std::span<const OpEntry> scene_words();

// Whether there is such a word, an op, `grid` or `mesh`; fills in what it takes.
[[nodiscard]] bool find_node_word(std::string_view word, NodeWord& found);
[[nodiscard]] const std::vector<std::string>& node_words();

}  // namespace sdfgrid
