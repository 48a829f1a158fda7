// scene/words.h: the words of scene files that are no ops of field/ (internal to scene/).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sdfgrid {

// What a word that makes a node takes.
struct NodeWord {
  std::vector<std::string> numbers;  // names of its parameters that are numbers
  std::vector<std::string> texts;    // of those that are texts
  bool leaf = false;
};

// Whether there is such a word, an op or `grid` or `mesh`; fills in what it takes.
[[nodiscard]] bool find_node_word(std::string_view word, NodeWord& found);
[[nodiscard]] const std::vector<std::string>& node_words();

}  // namespace sdfgrid
