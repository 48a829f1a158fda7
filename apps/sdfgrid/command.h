// apps/sdfgrid/command.h: what a subcommand is, and what it is given to work with.
//
// A subcommand is one file with an options struct, a function that registers the options and a
// function that does the work:
//
//   struct Options { std::string input; Output output; int dim = 0; };
//   Exit run(const Options& options, Context& context);
//
//   Run add_convert(CLI::App& app) {
//     auto options = std::make_shared<Options>();
//     app.add_option("IN", options->input, "mesh to convert")->required();
//     add_output(app, options->output, {".vdb"});              // options.h
//     return [options](Context& context) { return run(*options, context); };
//   }
//
// Declare add_NAME at the end of this header and add its line to the table in commands.cpp.
// Whatever goes wrong is thrown as sdfgrid::Error; main.cpp alone turns that into a message and an
// exit code.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sdfgrid/core/job.h"

namespace sdfgrid::cli {

using Json = nlohmann::ordered_json;

// The exit codes that other people's scripts rely on. A subcommand returns `done` or `missed`; the
// others follow from what it throws.
enum class Exit {
  done = 0,           // all that was asked was done
  failed = 1,         // it failed while working
  usage = 2,          // unknown word, missing argument, a value out of range
  missed = 3,         // done, but a stated tolerance was missed
  refused = 4,        // the input was refused
  interrupted = 130,  // no partial file is left
};

class Progress;

// What every subcommand is given: the Job to hand to the library, and where its results go.
class Context {
 public:
  Context(const Job& job, Progress& progress, bool json)
      : job_(job), progress_(progress), json_(json) {}

  [[nodiscard]] const Job& job() const { return job_; }

  // The keys of the JSON object that --json prints when the subcommand is done. Fill them always.
  [[nodiscard]] Json& result() { return result_; }

  // One line of the result for a reader, on standard output. Silent under --json.
  template <class... Args>
  void print(fmt::format_string<Args...> format, Args&&... args) {
    print_line(fmt::format(format, std::forward<Args>(args)...));
  }

  // Something the user should know though the work goes on: "warning: TEXT" on standard error
  // (silent under --quiet), and in the JSON object's `warnings`.
  void warn(const std::string& text);

  [[nodiscard]] bool json() const { return json_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void print_line(const std::string& line);

  const Job& job_;
  Progress& progress_;
  bool json_;
  Json result_ = Json::object();
  std::vector<std::string> warnings_;
};

// Wall-clock seconds of steps that follow each other, for the `seconds` of a result.
class Stopwatch {
 public:
  // Ends the step `name`, which began with the lap before or with the stopwatch. A name that comes
  // again adds up.
  void lap(const std::string& name);
  // {"read": 0.1, ..., "total": 0.5}; total counts from the stopwatch's construction to now.
  [[nodiscard]] Json seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
  Json steps_ = Json::object();
};

using Run = std::function<Exit(Context& context)>;

struct Command {
  std::string_view name;
  std::string_view arguments;  // as shown in the table: "IN -o OUT.vdb"
  std::string_view summary;    // what it does, one line, no full stop
  Run (*add)(CLI::App& app);   // registers the options; the Run reads them once they are parsed
};

// The table of subcommands, which also makes --help and the README's table.
[[nodiscard]] std::span<const Command> commands();

Run add_chart(CLI::App& app);
Run add_compare(CLI::App& app);
Run add_convert(CLI::App& app);
Run add_info(CLI::App& app);
Run add_render(CLI::App& app);
Run add_sample(CLI::App& app);
Run add_sculpt(CLI::App& app);
Run add_shapes(CLI::App& app);
Run add_transform(CLI::App& app);

}  // namespace sdfgrid::cli
