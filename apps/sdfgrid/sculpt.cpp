// sdfgrid sculpt: strokes on a distance grid, at once or in a session that survives crashes.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "command.h"
#include "options.h"
#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/edit/session.h"
#include "sdfgrid/edit/stroke_file.h"
#include "sdfgrid/scene/file_kind.h"
#include "sdfgrid/scene/stamp.h"

namespace sdfgrid::cli {
namespace {

struct Options {
  std::string input;
  std::string strokes;
  Output output;
  std::optional<Redistance> redistance;  // local, or the session's
  std::string session;
  bool resume = false;
  bool log = false;
  bool salvage = false;
  std::size_t undo = 0;
  std::size_t redo = 0;
};

std::vector<std::pair<std::string, std::optional<Redistance>>> redistance_choices() {
  std::vector<std::pair<std::string, std::optional<Redistance>>> choices;
  for (const Redistance mode : kRedistances) choices.emplace_back(redistance_word(mode), mode);
  return choices;
}

struct Totals {
  std::size_t strokes = 0;
  std::size_t dabs = 0;
  std::size_t bricks = 0;
};

[[noreturn]] void usage(const std::string& text) { throw Error(ErrorKind::usage, text); }

// Whether a file of that name would be in the folder, whatever links lead there.
bool lies_within(const std::string& file, const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code none;
  fs::path at = fs::weakly_canonical(fs::absolute(follow_links(file)), none).parent_path();
  for (; !at.empty(); at = at.parent_path()) {
    if (fs::equivalent(at, folder, none)) return true;
    if (at == at.root_path()) break;
  }
  return false;
}

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
  if (options.output.path.empty()) return;
  if (!options.session.empty() && lies_within(options.output.path, options.session)) {
    usage(options.output.path +
          ": the session's folder is for the session alone; give a file "
          "somewhere else");
  }
  check_output(options.output);
}

Grid read_input(const Options& options) {
  check_is_grid(options.input);
  return read_grid(options.input);
}

StrokeFile read_stroke_file(const Options& options, FileStamps& stamps, Context& context) {
  if (options.strokes.empty()) return {};
  check_is_strokes(options.strokes);
  StrokeFile file = read_strokes(options.strokes, &stamps);
  for (const StrokeWarning& warning : file.warnings) {
    const bool unknown = warning.kind == StrokeWarning::Kind::unknown_word;
    if (!unknown || options.session.empty()) {
      context.warn(warning.text);
      continue;
    }
    throw Error(ErrorKind::input,
                warning.text +
                    "; a session records only what it understands: mend the word or take "
                    "it out");
  }
  for (const std::string& warning : stamps.warnings()) context.warn(warning);
  return file;
}

std::string place_of(const StrokeFile& file, std::size_t i, const Options& options) {
  return fmt::format("{}: line {}: stroke {}", options.strokes, file.strokes[i].line, i + 1);
}

// Applies stroke i of the file by `apply`, which returns its report; what it refuses is the file's
// fault. `stand`: strokes before it that stand in the session.
template <class Apply>
StrokeReport apply_one(const StrokeFile& file, std::size_t i, std::size_t stand,
                       const Options& options, const Apply& apply) {
  try {
    return apply(file.strokes[i]);
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::usage) throw;
    throw Error(
        ErrorKind::input,
        fmt::format("{}: {}{}", place_of(file, i, options), e.what(),
                    stand > 0 ? fmt::format("; {} before it {} in the session: mend the file "
                                            "and go on with --resume",
                                            stand, stand == 1 ? "stands" : "stand")
                              : ""));
  }
}

// Applies the strokes from `first` on by `apply`, which returns a stroke's report.
template <class Apply>
Totals apply_all(const StrokeFile& file, std::size_t first, const Options& options,
                 Context& context, const Apply& apply) {
  Totals totals;
  const std::size_t count = file.strokes.size();
  for (std::size_t i = first; i < count; ++i) {
    const std::size_t stand = options.session.empty() ? 0 : i - first;
    const StrokeReport report = apply_one(file, i, stand, options, apply);
    for (const std::string& warning : report.warnings) {
      context.warn(fmt::format("{}: {}", place_of(file, i, options), warning));
    }
    totals.dabs += report.dabs;
    totals.bricks += report.bricks_touched;
    ++totals.strokes;
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
  context.print("{}, {}, {} touched in {:.3f} s", counted(totals.strokes, "stroke"),
                counted(totals.dabs, "dab"), counted(totals.bricks, "brick"), edit);
}

Exit sculpt_file(const Options& options, Context& context) {
  Stopwatch watch;
  FileStamps stamps(context.job());
  const StrokeFile file = read_stroke_file(options, stamps, context);
  const Grid grid = read_input(options);
  watch.lap("load");
  SculptOptions sculpt;
  sculpt.redistance = options.redistance.value_or(Redistance::local);
  sculpt.undo.full_bytes = 0;
  Sculptor sculptor(grid, sculpt);
  const Totals totals = apply_all(file, 0, options, context, [&](const Stroke& stroke) {
    return sculptor.apply(stroke, context.job());
  });
  watch.lap("edit");
  write(grid, options, context);
  watch.lap("write");
  describe(totals, watch, context);
  context.print("{}: {} in {}", options.output.path, counted(grid.active_voxels(), "active sample"),
                counted(grid.bricks(), "brick"));
  return Exit::done;
}

// How many strokes --resume leaves out: the most that are the first of the file and the last that
// stand in the session, whatever stands before them.
std::size_t already_there(Session& session, const StrokeFile& file) {
  const std::vector<std::string> standing = session.strokes();
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

// A first stroke that is refused must not leave a session without any, which the same command could
// not begin again: it is looked at before.
void check_first(const StrokeFile& file, const Grid& grid, const Options& options,
                 Context& context) {
  if (file.strokes.empty()) return;
  Sculptor sculptor(grid);
  (void)apply_one(file, 0, 0, options, [&](const Stroke& stroke) {
    check_recordable(stroke.text);
    sculptor.check(stroke, context.job());
    return StrokeReport();
  });
}

SessionLock begin_session(const Options& options, const StrokeFile& file, Context& context) {
  const Grid grid = read_input(options);
  check_first(file, grid, options, context);
  return create_session(options.session, grid, options.redistance.value_or(Redistance::local));
}

// Undoes or redoes strokes by `change`, which says how many there were.
template <class Change>
void go_through_history(std::size_t asked, const char* done, Context& context,
                        const Change& change) {
  if (asked == 0) return;
  const std::size_t count = change(asked);
  context.result()[done] = count;
  context.print("{} of {} {}", count, counted(asked, "stroke"), done);
  if (count == asked) return;
  context.warn(count == 0
                   ? fmt::format("there is no stroke to be {}", done)
                   : fmt::format("only {} of {} {} {}: there are no more", count,
                                 counted(asked, "stroke"), count == 1 ? "was" : "were", done));
}

void check_redistance(const Session& session, const Options& options) {
  const Redistance own = session.redistance();
  if (options.redistance.value_or(own) == own) return;
  usage(
      fmt::format("{}: the session was begun with --redistance {}, which its strokes keep; leave "
                  "the option out, or begin another session",
                  options.session, redistance_word(own)));
}

Exit run_session(const Options& options, Context& context) {
  Stopwatch watch;
  FileStamps stamps(context.job());
  const StrokeFile file = read_stroke_file(options, stamps, context);
  SessionOptions opening;
  opening.read_only = options.input.empty() && options.strokes.empty() && options.undo == 0 &&
                      options.redo == 0 && !options.salvage;
  opening.salvage = options.salvage;
  opening.stamps = &stamps;
  SessionLock lock;
  if (!options.input.empty()) lock = begin_session(options, file, context);
  Session session(options.session, opening, context.job(), std::move(lock));
  check_redistance(session, options);
  std::size_t told = 0;  // of its warnings
  const auto tell = [&] {
    for (; told < session.warnings().size(); ++told) context.warn(session.warnings()[told]);
  };
  tell();
  watch.lap("load");
  go_through_history(options.undo, "undone", context,
                     [&](std::size_t n) { return session.undo(n, context.job()); });
  go_through_history(options.redo, "redone", context,
                     [&](std::size_t n) { return session.redo(n, context.job()); });
  const std::size_t first = options.resume ? already_there(session, file) : 0;
  if (options.resume && !options.strokes.empty()) {
    context.result()["left_out"] = first;
    context.print("{} of {} of {} left out: the session ends with {}", first,
                  counted(file.strokes.size(), "stroke"), options.strokes,
                  first == 1 ? "it" : "them");
  }
  const Totals totals = apply_all(file, first, options, context, [&](const Stroke& stroke) {
    return session.apply(stroke, context.job());
  });
  watch.lap("edit");
  tell();
  if (options.log) print_log(session, context);
  if (!options.output.path.empty()) write(session.grid(), options, context);
  watch.lap("write");
  describe(totals, watch, context);
  const std::size_t standing = session.strokes().size();
  const std::size_t redoable = session.undone().size();
  context.result()["standing"] = standing;
  context.result()["redoable"] = redoable;
  context.print("{}: {} {}, {} can be redone", options.session, counted(standing, "stroke"),
                standing == 1 ? "stands" : "stand", redoable);
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
  add_choice(app, "--redistance", options->redistance, redistance_choices(),
             "which distances are measured anew after a stroke");
  app.add_option("--session", options->session, "folder that keeps every stroke, made with GRID")
      ->type_name("DIR");
  app.add_flag("--resume", options->resume,
               "open the session; the first strokes of the file are left out, as many as the "
               "session ends with");
  const CLI::Validator count = whole_number(1, std::numeric_limits<int>::max());
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
