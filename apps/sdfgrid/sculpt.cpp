// sdfgrid sculpt: strokes on a distance grid, at once or in a session that survives crashes.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

#include "command.h"
#include "options.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/edit/session.h"
#include "sdfgrid/edit/stroke_file.h"
#include "sdfgrid/scene/stamp.h"

namespace sdfgrid::cli {
namespace {

struct Options {
  std::string input;
  std::string strokes;
  Output output;
  Redistance redistance = Redistance::local;
  std::string session;
  bool resume = false;
  bool log = false;
  bool salvage = false;
  std::size_t undo = 0;
  std::size_t redo = 0;
};

const std::vector<std::pair<std::string, Redistance>> kRedistances = {
    {"off", Redistance::off}, {"local", Redistance::local}, {"full", Redistance::full}};

struct Totals {
  std::size_t strokes = 0;
  std::size_t dabs = 0;
  std::size_t bricks = 0;
};

[[noreturn]] void usage(const std::string& text) { throw Error(ErrorKind::usage, text); }

// What can be asked together.
void check(const Options& options) {
  const bool opens = options.resume || options.log || options.undo > 0 || options.redo > 0;
  if (options.session.empty()) {
    if (opens || options.salvage)
      usage("--resume, --log, --undo, --redo and --salvage need --session DIR");
    if (options.input.empty()) usage("give the GRID to sculpt, or --session DIR");
    if (options.strokes.empty()) usage("give --strokes FILE");
    if (options.output.path.empty()) usage("give -o OUT.vdb, or --session DIR to keep the work in");
  } else if (options.input.empty() && !opens && options.output.path.empty() &&
             options.strokes.empty()) {
    usage(
        "say what to do with the session: --resume, --strokes, --undo N, --redo N, --log, "
        "--export");
  }
  if (!options.input.empty() && opens) {
    usage("a session that is opened has its grid already; leave GRID out");
  }
  if (!options.output.path.empty()) check_output(options.output);
}

StrokeFile read_stroke_file(const Options& options, FileStamps& stamps, Context& context) {
  if (options.strokes.empty()) return {};
  StrokeFile file = read_strokes(options.strokes, &stamps);
  for (const std::string& warning : file.warnings) context.warn(warning);
  for (const std::string& warning : stamps.warnings()) context.warn(warning);
  return file;
}

// Applies the strokes from `first` on by `apply`, which returns a stroke's report.
template <class Apply>
Totals apply_all(const StrokeFile& file, std::size_t first, const Options& options,
                 Context& context, const Apply& apply) {
  const std::string& source = options.strokes;
  const bool in_session = !options.session.empty();
  Totals totals;
  const std::size_t count = file.strokes.size();
  for (std::size_t i = first; i < count; ++i) {
    const std::string name = fmt::format("{}: stroke {}", source, i + 1);
    try {
      const StrokeReport report = apply(file.strokes[i]);
      for (const std::string& warning : report.warnings) context.warn(name + ": " + warning);
      totals.dabs += report.dabs;
      totals.bricks += report.bricks_touched;
      ++totals.strokes;
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::usage) throw;
      const std::size_t stand = i - first;
      throw Error(ErrorKind::input,
                  fmt::format("{}: {}{}", name, e.what(),
                              in_session && stand > 0
                                  ? fmt::format("; {} before it stand in the session: mend the "
                                                "file and go on with --resume",
                                                stand)
                                  : ""));
    }
    context.job().report("sculpt", static_cast<double>(i + 1) / static_cast<double>(count));
  }
  return totals;
}

void write(const Grid& grid, const Options& options, Context& context) {
  context.job().report("write", 0.0);
  context.job().checkpoint();
  compact(grid);
  Grid stamped = grid;
  // Re-distancing measures to the surface that the samples hold; docs/methods.md has the bounds.
  stamped.set_metadata("sdfgrid:method", "sculpt");
  stamped.set_metadata("sdfgrid:version", SDFGRID_VERSION);
  stamped.remove_metadata("sdfgrid:max_error");
  write_grid(stamped, options.output.path);
  if (!grid.has_inside()) context.warn("nothing is left of the model: the grid has no inside");
}

void describe(const Totals& totals, const Stopwatch& watch, Context& context) {
  const Json seconds = watch.seconds();
  const double edit = seconds.value("edit", 0.0);
  Json& result = context.result();
  result["strokes"] = totals.strokes;
  result["dabs"] = totals.dabs;
  result["bricks_touched"] = totals.bricks;
  result["seconds"] = seconds;
  result["dabs_per_second"] = edit > 0 ? static_cast<double>(totals.dabs) / edit : 0.0;
  if (totals.strokes == 0) return;
  context.print("{} strokes, {} dabs, {} bricks touched in {:.3f} s", totals.strokes, totals.dabs,
                totals.bricks, edit);
}

Exit sculpt_file(const Options& options, Context& context) {
  Stopwatch watch;
  FileStamps stamps(context.job());
  const StrokeFile file = read_stroke_file(options, stamps, context);
  const Grid grid = read_grid(options.input);
  watch.lap("load");
  SculptOptions sculpt;
  sculpt.redistance = options.redistance;
  sculpt.undo.full_bytes = 0;
  Sculptor sculptor(grid, sculpt);
  const Totals totals = apply_all(file, 0, options, context, [&](const Stroke& stroke) {
    return sculptor.apply(stroke, context.job());
  });
  watch.lap("edit");
  write(grid, options, context);
  watch.lap("write");
  describe(totals, watch, context);
  context.print("{}: {} active samples in {} bricks", options.output.path, grid.active_voxels(),
                grid.bricks());
  return Exit::done;
}

// How many strokes --resume leaves out: the most that are the first of the file and the last that
// stand in the session, whatever stands before them.
std::size_t already_there(Session& session, const StrokeFile& file) {
  const std::vector<std::string>& standing = session.strokes();
  std::vector<std::string> first(std::min(standing.size(), file.strokes.size()));
  std::transform(file.strokes.begin(), file.strokes.begin() + std::ssize(first), first.begin(),
                 [&](const Stroke& stroke) { return session.recorded_text(stroke); });
  std::ptrdiff_t count = std::ssize(first);
  while (!std::equal(standing.end() - count, standing.end(), first.begin())) --count;
  return static_cast<std::size_t>(count);
}

void print_log(const Session& session, Context& context) {
  Json lines = Json::array();
  for (std::size_t i = 1; i < session.log().size(); ++i) {
    context.print("{:6} {}", i, session.log()[i].text);
    lines.push_back(session.log()[i].text);
  }
  context.result()["log"] = lines;
}

Exit run_session(const Options& options, Context& context) {
  Stopwatch watch;
  FileStamps stamps(context.job());
  const StrokeFile file = read_stroke_file(options, stamps, context);
  if (!options.input.empty()) {
    create_session(options.session, read_grid(options.input), options.redistance);
  }
  SessionOptions opening;
  opening.salvage = options.salvage;
  opening.stamps = &stamps;
  Session session(options.session, opening, context.job());
  watch.lap("load");
  if (options.undo > 0) context.result()["undone"] = session.undo(options.undo, context.job());
  if (options.redo > 0) context.result()["redone"] = session.redo(options.redo, context.job());
  const std::size_t first = options.resume ? already_there(session, file) : 0;
  if (options.resume && !options.strokes.empty()) {
    context.result()["left_out"] = first;
    context.print("{} of {} strokes of {} left out: the session ends with them", first,
                  file.strokes.size(), options.strokes);
  }
  const Totals totals = apply_all(file, first, options, context, [&](const Stroke& stroke) {
    return session.apply(stroke, context.job());
  });
  watch.lap("edit");
  for (const std::string& warning : session.warnings()) context.warn(warning);
  if (options.log) print_log(session, context);
  if (!options.output.path.empty()) {
    write(session.grid(), options, context);
    watch.lap("write");
  }
  describe(totals, watch, context);
  context.result()["standing"] = session.strokes().size();
  context.result()["redoable"] = session.undone().size();
  context.print("{}: {} strokes stand, {} can be redone", options.session, session.strokes().size(),
                session.undone().size());
  return Exit::done;
}

Exit run(const Options& options, Context& context) {
  check(options);
  return options.session.empty() ? sculpt_file(options, context) : run_session(options, context);
}

}  // namespace

Run add_sculpt(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("GRID", options->input, "level set to sculpt: .vdb");
  app.add_option("--strokes", options->strokes, "stroke file to apply (docs/sculpting.md)")
      ->type_name("FILE");
  options->output.extensions = {".vdb"};
  app.add_option("-o,--output,--export", options->output.path, "grid to write: .vdb")
      ->type_name("FILE");
  app.add_flag("--force", options->output.force, "write over an existing output file");
  add_choice(app, "--redistance", options->redistance, kRedistances,
             "which distances are measured anew after a stroke");
  app.add_option("--session", options->session, "folder that keeps every stroke, made with GRID")
      ->type_name("DIR");
  app.add_flag("--resume", options->resume,
               "open the session; the first strokes of the file are left out, as many as the "
               "session ends with");
  const CLI::Range count(1, std::numeric_limits<int>::max());
  app.add_option("--undo", options->undo, "undo the last N strokes of the session")
      ->type_name("N")
      ->check(count);
  app.add_option("--redo", options->redo, "redo N of them")->type_name("N")->check(count);
  app.add_flag("--log", options->log, "print what the session recorded");
  app.add_flag("--salvage", options->salvage,
               "go on from the last good record of a damaged journal");
  return [options](Context& context) { return run(*options, context); };
}

}  // namespace sdfgrid::cli
