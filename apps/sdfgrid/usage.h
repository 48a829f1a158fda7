// apps/sdfgrid/usage.h: what a user is told who asked for help or needs it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace sdfgrid::cli {

// The table of subcommands in Markdown, as it stands in the README.
[[nodiscard]] std::string command_table();

// What is wrong with a command line that CLI11 refused, and where to read on. A mistyped word is
// named first, with the nearest right one, whatever CLI11 stumbled over because of it.
[[nodiscard]] std::string explain_usage(const CLI::App& app, const std::vector<std::string>& words,
                                        const CLI::ParseError& error);

// Whether --json is among the words, for a command line that could not be parsed.
[[nodiscard]] bool asks_for_json(const std::vector<std::string>& words);

}  // namespace sdfgrid::cli
