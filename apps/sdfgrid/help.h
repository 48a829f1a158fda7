// apps/sdfgrid/help.h: how --help looks.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

namespace sdfgrid::cli {

// A formatter that shows an option as "--dim N", its help and its default, and a subcommand's usage
// as "Usage: sdfgrid USAGE".
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_format(const std::string& usage);

}  // namespace sdfgrid::cli
