// sdfgrid shapes: the words of scene files, from the list of ops.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>
#include <vector>

#include "command.h"
#include "options.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/words.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/field/formula.h"
#include "sdfgrid/scene/words.h"

namespace sdfgrid::cli {
namespace {

struct Options {
  std::string name;
  bool markdown = false;
  bool example = false;
};

const char* name_of(OpRole role) {
  switch (role) {
    case OpRole::leaf:
      return "shape";
    case OpRole::combination:
      return "combination";
    case OpRole::range:
      return "of one node's distance";
    case OpRole::domain:
      break;
  }
  return "of one node's space";
}

const char* name_of(OpGuarantee guarantee) {
  switch (guarantee) {
    case OpGuarantee::exact:
      return "exact";
    case OpGuarantee::exact_outside:
      return "exact outside, a bound inside";
    case OpGuarantee::exact_inside:
      return "exact inside, a bound outside";
    case OpGuarantee::bound:
      return "bound";
    case OpGuarantee::computed:
      return "bound, computed over its region";
    case OpGuarantee::estimate:
      break;
  }
  return "estimate";
}

const char* name_of(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::number:
      return "number";
    case ParameterKind::whole:
      return "whole number";
    case ParameterKind::pair:
      return "one or two numbers";
    case ParameterKind::vector:
      return "three numbers";
    case ParameterKind::matrix:
      return "nine numbers";
    case ParameterKind::numbers:
      return "list of numbers";
    case ParameterKind::points:
      return "list of points";
    case ParameterKind::text:
      break;
  }
  return "text";
}

// "number, length, at least 1e-06, default 1".
std::string traits(const Parameter& p) {
  std::string text = name_of(p.kind);
  if (*p.unit != 0) text += fmt::format(", {}", p.unit);
  if (p.kind == ParameterKind::text) return std::isnan(p.fallback[0]) ? text + ", required" : text;
  constexpr double kAnyNumber = 1e9;
  if (p.lo > -kAnyNumber) text += fmt::format(", at least {:g}", p.lo);
  if (p.hi < kAnyNumber) text += fmt::format(", at most {:g}", p.hi);
  if (std::isnan(p.fallback[0])) return text + ", required";
  if (p.kind == ParameterKind::pair) {
    return text + fmt::format(", default [{:g}, {:g}]", p.fallback[0], p.fallback[1]);
  }
  if (p.kind == ParameterKind::vector) {
    return text +
           fmt::format(", default [{:g}, {:g}, {:g}]", p.fallback[0], p.fallback[1], p.fallback[2]);
  }
  const bool one = p.kind == ParameterKind::number || p.kind == ParameterKind::whole;
  return one ? text + fmt::format(", default {:g}", p.fallback[0]) : text;
}

// Whether the example needs a file beside it, so that there is no picture of it.
bool takes_file(const OpEntry& op) {
  return std::any_of(op.parameters.begin(), op.parameters.end(), [](const Parameter& p) {
    return std::string_view(p.name) == "file" && std::isnan(p.fallback[0]);
  });
}

// All words of nodes, ordered by their roles.
std::vector<OpEntry> words() {
  std::vector<OpEntry> all(op_list().begin(), op_list().end());
  all.insert(all.end(), scene_words().begin(), scene_words().end());
  std::stable_sort(all.begin(), all.end(),
                   [](const OpEntry& a, const OpEntry& b) { return a.info->role < b.info->role; });
  return all;
}

// The op beside whose parameters the functions stand that all formulas may call.
bool explains_formulas(const OpEntry& op) { return std::string_view(op.info->name) == "formula"; }

Json describe(const OpEntry& op) {
  Json parameters = Json::array();
  for (const Parameter& p : op.parameters) {
    parameters.push_back({{"name", p.name},
                          {"kind", name_of(p.kind)},
                          {"unit", p.unit},
                          {"min", p.lo},
                          {"max", p.hi},
                          {"required", std::isnan(p.fallback[0])},
                          {"text", p.text}});
  }
  Json all = {{"name", op.info->name},
              {"role", name_of(op.info->role)},
              {"distance", name_of(op.info->guarantee)},
              {"text", op.info->text},
              {"example", op.info->example},
              {"parameters", parameters}};
  if (explains_formulas(op)) {
    for (const FormulaFunction& f : formula_functions()) {
      all["functions"].push_back({{"name", f.name}, {"arguments", f.arguments}, {"text", f.text}});
    }
  }
  return all;
}

void print(const OpEntry& op, Context& context) {
  context.print("{:<20} {}; {}", op.info->name, name_of(op.info->role),
                name_of(op.info->guarantee));
  context.print("    {}", op.info->text);
  for (const Parameter& p : op.parameters) {
    context.print("    {:<16} {} ({})", p.name, p.text, traits(p));
  }
  if (explains_formulas(op)) {
    context.print("    functions of all formulas:");
    for (const FormulaFunction& f : formula_functions()) {
      context.print("      {:<14} {}", fmt::format("{}({})", f.name, f.arguments), f.text);
    }
  }
  context.print("    as in {{{}}}", op.info->example);
}

void print_markdown(const OpEntry& op, Context& context) {
  context.print("### {}\n", op.info->name);
  if (!takes_file(op)) context.print("![{0}](images/shapes/{0}.png)\n", op.info->name);
  context.print("{} Distance: {}.\n", op.info->text, name_of(op.info->guarantee));
  if (*op.info->source != 0) context.print("Source: {}.\n", op.info->source);
  for (const Parameter& p : op.parameters) {
    context.print("- `{}`: {} ({})", p.name, p.text, traits(p));
  }
  if (explains_formulas(op)) {
    context.print("\nFunctions that all formulas may call:\n\n| function | value |\n|---|---|");
    for (const FormulaFunction& f : formula_functions()) {
      context.print("| `{}({})` | {} |", f.name, f.arguments, f.text);
    }
  }
  context.print("{}```yaml\n- {}\n```\n", op.parameters.empty() ? "" : "\n", op.info->example);
}

void print_all(bool markdown, Context& context) {
  OpRole role = OpRole::leaf;
  bool first = true;
  for (const OpEntry& op : words()) {
    if (markdown && (first || op.info->role != role)) {
      context.print("## {}{}\n",
                    op.info->role == OpRole::leaf          ? "Shapes"
                    : op.info->role == OpRole::combination ? "Combinations"
                                                           : "Of one node: ",
                    op.info->role == OpRole::range    ? "its distance"
                    : op.info->role == OpRole::domain ? "its space"
                                                      : "");
    }
    first = false;
    role = op.info->role;
    markdown ? print_markdown(op, context) : print(op, context);
  }
}

OpEntry find(const std::string& name) {
  const std::vector<OpEntry> all = words();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const OpEntry& word) { return word.info->name == name; });
  if (found != all.end()) return *found;
  std::vector<std::string> names;
  names.reserve(all.size());
  for (const OpEntry& op : all) names.emplace_back(op.info->name);
  const std::string near = nearest_word(name, names);
  throw Error(ErrorKind::usage,
              fmt::format("there is no shape '{}'{}", name,
                          near.empty() ? "" : fmt::format(" (did you mean '{}'?)", near)));
}

Exit run(const Options& options, Context& context) {
  if (options.name.empty()) {
    Json all = Json::array();
    for (const OpEntry& op : words()) all.push_back(describe(op));
    context.result()["shapes"] = all;
    print_all(options.markdown, context);
    return Exit::done;
  }
  const OpEntry op = find(options.name);
  context.result()["shapes"] = Json::array({describe(op)});
  if (options.example) {
    context.print("sdfgrid: 1\nscene:\n  - {{{}}}", op.info->example);
  } else {
    options.markdown ? print_markdown(op, context) : print(op, context);
  }
  return Exit::done;
}

}  // namespace

Run add_shapes(CLI::App& app) {
  auto options = std::make_shared<Options>();
  auto* name = app.add_option("NAME", options->name, "one of them; all if not given");
  app.add_flag("--markdown", options->markdown, "as docs/shapes.md has them");
  app.add_flag("--example", options->example, "a scene that shows it")->needs(name);
  return [options](Context& context) { return run(*options, context); };
}

}  // namespace sdfgrid::cli
