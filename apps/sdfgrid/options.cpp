#include "options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/words.h"

namespace sdfgrid::cli {

namespace fs = std::filesystem;

void add_output(CLI::App& app, Output& output, std::vector<std::string> extensions) {
  output.extensions = std::move(extensions);
  app.add_option("-o,--output", output.path, "file to write: " + one_of(output.extensions))
      ->required()
      ->type_name("FILE");
  app.add_flag("--force", output.force, "write over an existing output file");
}

void check_output(const Output& output) {
  const auto refuse = [&](const std::string& problem) {
    throw Error(ErrorKind::usage, output.path + ": " + problem);
  };
  if (!has_extension(output.path, output.extensions)) {
    refuse("the output must be named " + one_of(output.extensions));
  }
  const fs::path target(follow_links(output.path));
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    refuse(fmt::format("there is no folder {}; create it first", folder.string()));
  }
  // A link that leads nowhere is something that exists, too.
  if (fs::exists(fs::symlink_status(output.path, ignored))) {
    // A rename over /dev/null would replace the device for everybody.
    if (fs::exists(target, ignored) && !fs::is_regular_file(target, ignored)) {
      refuse("exists and is not a plain file");
    }
    if (!output.force) refuse("exists already; give --force to write over it, or another name");
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    throw Error(ErrorKind::failed,
                fmt::format("{}: the folder {} cannot be written", output.path, folder.string()));
  }
}

CLI::Validator finite_number() {
  return CLI::Validator(
      [](const std::string& text) {
        double value = 0;
        const bool finite = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
        return finite ? std::string() : "'" + text + "' is not a finite number";
      },
      "");
}

CLI::Validator whole_number(std::int64_t lo, std::int64_t hi) {
  return CLI::Validator(
      [lo, hi](const std::string& text) {
        std::int64_t value = 0;
        const bool whole = CLI::detail::lexical_cast(text, value) && value >= lo && value <= hi;
        return whole ? std::string()
                     : fmt::format("'{}' is not a whole number from {} to {}", text, lo, hi);
      },
      fmt::format("INT in [{} - {}]", lo, hi));
}

bool has_extension(const std::string& path, const std::vector<std::string>& extensions) {
  return std::find(extensions.begin(), extensions.end(), extension_of(path)) != extensions.end();
}

std::string counted(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string one_of(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += words[i];
  }
  return text;
}

namespace {

std::string unknown_word(const std::string& given, const std::vector<std::string>& words) {
  const std::string near = nearest_word(given, words);
  const std::string hint = near.empty() ? "" : fmt::format(" (did you mean '{}'?)", near);
  return fmt::format("'{}' is not known{}; it takes {}", given, hint, one_of(words));
}

}  // namespace

CLI::Validator known_word(const std::vector<std::string>& words) {
  const auto problem = [words](const std::string& given) {
    const bool known = std::find(words.begin(), words.end(), given) != words.end();
    return known ? std::string() : unknown_word(given, words);
  };
  return {problem, ""};
}

void refuse_choice(const std::string& option, const std::string& given,
                   const std::vector<std::string>& words) {
  throw CLI::ValidationError(option, unknown_word(given, words));
}

}  // namespace sdfgrid::cli
