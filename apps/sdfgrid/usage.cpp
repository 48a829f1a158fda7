#include "usage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <regex>

#include "command.h"
#include "sdfgrid/core/words.h"

namespace sdfgrid::cli {
namespace {

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const Command& command : commands()) names.emplace_back(command.name);
  return names;
}

// "--size" and "-o" as they are typed.
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

// Whether the word is written as an option; "-0.5" and "-.5" are numbers.
bool is_option(const std::string& word) {
  if (word.size() < 2 || word[0] != '-') return false;
  return word[1] == '-' || std::isalpha(static_cast<unsigned char>(word[1])) != 0;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const std::string near = nearest_word(word, known);
  return near.empty() ? "" : fmt::format("; did you mean '{}'?", near);
}

// The option of `app` that a word names, also as "--name=value" and "-nvalue"; null if none does.
const CLI::Option* find_option(const CLI::App& app, const std::string& word) {
  const bool is_long = word.starts_with("--");
  return app.get_option_no_throw(is_long ? word.substr(0, word.find('=')) : word.substr(0, 2));
}

// The complaint about the first option that `app` does not have, or "".
std::string unknown_option(const CLI::App& app, const std::vector<std::string>& words) {
  bool is_value = false;  // of the option before it, whatever it looks like
  for (const std::string& word : words) {
    if (word == "--") break;
    if (is_value || !is_option(word)) {
      is_value = false;
      continue;
    }
    const CLI::Option* option = find_option(app, word);
    if (option == nullptr) {
      const std::string name = word.substr(0, word.find('='));
      return fmt::format("unknown option '{}'{}", name, did_you_mean(name, option_names(app)));
    }
    const bool holds_value = word.starts_with("--") ? word.find('=') != word.npos : word.size() > 2;
    is_value = option->get_expected_min() > 0 && option->get_type_size() > 0 && !holds_value;
  }
  return "";
}

}  // namespace

std::string command_table() {
  std::string table = "| command | what it does |\n|---|---|\n";
  for (const Command& command : commands()) {
    const std::string row = fmt::format("`{} {}`", command.name, command.arguments);
    table += fmt::format("| {} | {} |\n", std::regex_replace(row, std::regex("\\|"), "\\|"),
                         command.summary);
  }
  return table;
}

std::string explain_usage(const CLI::App& app, const std::vector<std::string>& words,
                          const CLI::ParseError& error) {
  const std::vector<std::string> names = command_names();
  const bool named = !words.empty() && !is_option(words.front());
  if (named && std::find(names.begin(), names.end(), words.front()) != names.end()) {
    const CLI::App& sub = *app.get_subcommand(words.front());
    std::string problem = unknown_option(sub, {words.begin() + 1, words.end()});
    if (problem.empty()) problem = error.what();
    return fmt::format("{}: {}\nRun 'sdfgrid {} --help' for what it takes.", words.front(), problem,
                       words.front());
  }
  std::string problem = named           ? fmt::format("unknown command '{}'{}", words.front(),
                                                      did_you_mean(words.front(), names))
                        : words.empty() ? "a command is missing"
                                        : unknown_option(app, words);
  if (problem.empty()) problem = error.what();
  return fmt::format("{}\nThe commands are {}. Run 'sdfgrid --help' for more.", problem,
                     fmt::join(names, ", "));
}

bool asks_for_json(const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), "--json") != words.end();
}

}  // namespace sdfgrid::cli
