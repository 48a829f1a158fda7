// apps/sdfgrid/options.h: the options that several subcommands share, so that they read and fail
// alike everywhere.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sdfgrid/core/file_name.h"

namespace sdfgrid::cli {

// An output file, asked for by `-o, --output` and protected by `--force`.
struct Output {
  std::string path;
  bool force = false;
  std::vector<std::string> extensions;  // accepted ones, lower case with the dot
};

// Registers -o (required) and --force.
void add_output(CLI::App& app, Output& output, std::vector<std::string> extensions);

// Call it before any work. Throws Error{usage} for an extension that is not accepted, a missing
// folder, something that is not a plain file, or an existing file without --force; Error{failed}
// where the folder cannot be written.
void check_output(const Output& output);

// A check for options: refuses nan and infinity, which comparisons with a range let pass.
[[nodiscard]] CLI::Validator finite_number();

// The same: whole numbers from lo to hi.
[[nodiscard]] CLI::Validator whole_number(std::int64_t lo, std::int64_t hi);

// Whether a path has one of some extensions.
[[nodiscard]] bool has_extension(const std::string& path,
                                 const std::vector<std::string>& extensions);

// "1 stroke", "2 strokes".
[[nodiscard]] std::string counted(std::size_t count, const std::string& what);

// "a, b or c".
[[nodiscard]] std::string one_of(const std::vector<std::string>& words);

// A check for options that take some of these words; names the nearest one of another.
[[nodiscard]] CLI::Validator known_word(const std::vector<std::string>& words);

// Throws CLI::ValidationError naming the nearest of `words` to the `given` one.
[[noreturn]] void refuse_choice(const std::string& option, const std::string& given,
                                const std::vector<std::string>& words);

// An option whose value is one of a few words; `value` keeps what it had if the option is not
// given.
template <class T>
CLI::Option* add_choice(CLI::App& app, const std::string& option, T& value,
                        const std::vector<std::pair<std::string, T>>& choices,
                        const std::string& help) {
  std::vector<std::string> words;
  words.reserve(choices.size());
  for (const auto& choice : choices) words.push_back(choice.first);
  const auto take = [&value, option, choices, words](const std::string& given) {
    for (const auto& [word, meaning] : choices) {
      if (word == given) {
        value = meaning;
        return;
      }
    }
    refuse_choice(option, given, words);
  };
  return app.add_option_function<std::string>(option, take, help + ": " + one_of(words))
      ->type_name("WORD");
}

}  // namespace sdfgrid::cli
