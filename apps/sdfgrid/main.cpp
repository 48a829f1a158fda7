// The command line: parses it, runs one subcommand, and turns what comes of it into an exit code.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <optional>

#include "command.h"
#include "help.h"
#include "interrupt.h"
#include "options.h"
#include "progress.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/isa.h"
#include "sdfgrid/core/parallel.h"
#include "usage.h"

namespace sdfgrid::cli {
namespace {

// Every subcommand takes these.
struct CommonOptions {
  int threads = 0;  // 0: all cores
  bool json = false;
  bool quiet = false;
};

struct Failure {
  Exit exit;
  std::string message;
};

void add_common_options(CLI::App& app, CommonOptions& options) {
  app.add_option("--threads", options.threads, "threads to use; 0 means all cores")
      ->check(whole_number(0, 1024))
      ->type_name("N");
  app.add_flag("--json", options.json, "print the result as one JSON object");
  app.add_flag("--quiet", options.quiet, "no progress and no warnings on standard error");
}

Exit exit_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return Exit::usage;
    case ErrorKind::input:
      return Exit::refused;
    case ErrorKind::cancelled:
      return Exit::interrupted;
    case ErrorKind::failed:
      break;
  }
  return Exit::failed;
}

// The one place where exceptions become exit codes. `exit` is set if there was none.
std::optional<Failure> attempt(const Run& run, Context& context, Exit& exit) {
  try {
    exit = run(context);
    return std::nullopt;
  } catch (const Error& e) {
    return Failure{exit_of(e.kind()), e.what()};
  } catch (const CLI::ParseError& e) {
    return Failure{Exit::usage, e.what()};
  } catch (const std::bad_alloc&) {
    return Failure{Exit::failed, "out of memory; ask for less detail, or give the program more"};
  } catch (const std::exception& e) {
    return Failure{Exit::failed, e.what()};
  }
}

Json failure_json(const Failure& failure, const std::vector<std::string>& warnings) {
  return {
      {"error", failure.message}, {"exit", static_cast<int>(failure.exit)}, {"warnings", warnings}};
}

// One line, so that results of many runs gather in one file. File names need not be UTF-8.
std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

int fail(const Failure& failure, bool json, const std::vector<std::string>& warnings = {}) {
  std::fputs(fmt::format("error: {}\n", failure.message).c_str(), stderr);
  if (json) std::fputs(dump(failure_json(failure, warnings)).c_str(), stdout);
  std::fflush(stdout);
  return static_cast<int>(failure.exit);
}

// A result that did not reach its reader was not delivered. One who closed the pipe has read
// enough.
bool deliver_stdout() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return true;
  return errno == EPIPE;
}

// With write(2): the interrupted work may hold the locks of stdio.
void last_words(bool json) {
  const Failure failure{Exit::interrupted, "interrupted"};
  const std::string message = fmt::format("error: {}\n", failure.message);
  const std::string object = json ? dump(failure_json(failure, {})) : "";
  // Nothing is left to do about a failing write here.
  if (::write(STDERR_FILENO, message.data(), message.size()) < 0) return;
  if (::write(STDOUT_FILENO, object.data(), object.size()) < 0) return;
}

int run_command(const Run& run, const CommonOptions& options) {
  Progress progress(options.quiet ? Progress::Style::none : Progress::style_for_stderr());
  const Job job([&](std::string_view step, double fraction) { progress.report(step, fraction); });
  InterruptWatch watch(job, [&] { last_words(options.json); });
  const ThreadLimit limit(options.threads);
  Context context(job, progress, options.json);

  Exit exit = Exit::done;
  const std::optional<Failure> failure = attempt(run, context, exit);
  watch.stand_down();
  progress.clear();
  if (failure) return fail(*failure, options.json, context.warnings());
  if (options.json) {
    context.result()["warnings"] = context.warnings();
    std::fputs(dump(context.result()).c_str(), stdout);
  }
  if (!deliver_stdout()) {
    return fail({Exit::failed, fmt::format("standard output: {}", std::strerror(errno))}, false);
  }
  return static_cast<int>(exit);
}

std::string version_text() {
  return fmt::format("sdfgrid {}\nlicence of this binary: {}\nvector instructions: {}",
                     SDFGRID_VERSION, SDFGRID_BINARY_LICENCE, isa_name(active_isa()));
}

int main_with(int argc, char** argv) {
  CLI::App app("Turns meshes into exact sparse distance grids, measures them and renders them.",
               "sdfgrid");
  app.set_version_flag("--version", version_text());
  app.add_flag_callback("--help-table",
                        [] {
                          std::fputs(command_table().c_str(), stdout);
                          throw CLI::Success();
                        })
      ->group("");  // hidden: it makes the README's table
  app.require_subcommand(1);
  app.formatter(help_format("COMMAND ..."));

  CommonOptions options;
  std::vector<std::pair<CLI::App*, Run>> runs;
  for (const Command& command : commands()) {
    CLI::App* sub = app.add_subcommand(std::string(command.name), std::string(command.summary));
    sub->formatter(help_format(fmt::format("{} {} [OPTIONS]", command.name, command.arguments)));
    runs.emplace_back(sub, command.add(*sub));
    add_common_options(*sub, options);
  }
  app.footer("Run 'sdfgrid COMMAND --help' for what a command takes.");
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    app.exit(e);
    return static_cast<int>(deliver_stdout() ? Exit::done : Exit::failed);
  } catch (const CLI::ParseError& e) {
    return fail({Exit::usage, explain_usage(app, words, e)}, asks_for_json(words));
  }
  for (const auto& [sub, run] : runs) {
    if (sub->parsed()) return run_command(run, options);
  }
  return static_cast<int>(Exit::usage);
}

}  // namespace
}  // namespace sdfgrid::cli

int main(int argc, char** argv) {
  // A closed pipe must not end the program in the middle of an output file.
  std::signal(SIGPIPE, SIG_IGN);
  // A write beyond the user's file size limit then fails like one to a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  return sdfgrid::cli::main_with(argc, argv);
}
