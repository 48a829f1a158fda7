#include "sdfgrid/scene/words.h"

#include <algorithm>

#include "sdfgrid/field/field.h"

namespace sdfgrid {

bool find_node_word(std::string_view word, NodeWord& found) {
  if (word == "grid") {
    found = {{}, {"file"}, true};
    return true;
  }
  if (word == "mesh") {
    found = {{"dim"}, {"file"}, true};
    return true;
  }
  const OpEntry* op = find_op(word);
  if (op == nullptr) return false;
  found = {{}, {}, op->info->role == OpRole::leaf};
  for (const Parameter& p : op->parameters) {
    (p.kind == ParameterKind::text ? found.texts : found.numbers).emplace_back(p.name);
  }
  return true;
}

const std::vector<std::string>& node_words() {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> all = {"grid", "mesh", "displace"};
    for (const OpEntry& op : op_list()) all.emplace_back(op.info->name);
    return all;
  }();
  return words;
}

}  // namespace sdfgrid
