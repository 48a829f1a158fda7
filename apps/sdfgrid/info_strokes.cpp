// sdfgrid info of what sculpting writes and takes: sessions and stroke files.
#include "info_strokes.h"

#include <algorithm>
#include <map>

#include "options.h"
#include "sdfgrid/edit/session_records.h"
#include "sdfgrid/edit/session_summary.h"
#include "sdfgrid/edit/stroke_file.h"
#include "sdfgrid/scene/stamp.h"

namespace sdfgrid::cli {
namespace {

// The first of them, and how many more there are.
void print_strokes(const std::vector<std::string>& texts, Context& context) {
  constexpr std::size_t kShown = 20;
  for (std::size_t i = 0; i < std::min(texts.size(), kShown); ++i) {
    context.print("{:6} {}", i + 1, texts[i]);
  }
  if (texts.size() > kShown) context.print("       and {} more", texts.size() - kShown);
}

}  // namespace

void report_session(const std::string& folder, Context& context) {
  const SessionSummary session = summarize_session(folder);
  Json& result = context.result();
  result["kind"] = "session";
  result["bounds"] = Json();
  result["strokes"] = session.strokes.size();
  result["redoable"] = session.redoable;
  result["records"] = session.records;
  result["snapshots"] = session.snapshots;
  result["redistance"] = redistance_word(session.redistance);
  result["damaged"] = session.damaged;
  context.print("session    {} {}, {} can be redone", counted(session.strokes.size(), "stroke"),
                session.strokes.size() == 1 ? "stands" : "stand", session.redoable);
  context.print("journal    {}, {}; begun with --redistance {}", counted(session.records, "record"),
                counted(session.snapshots, "snapshot"), redistance_word(session.redistance));
  print_strokes(session.strokes, context);
  context.print("go on      sdfgrid sculpt --session {} --resume --strokes MORE.yaml", folder);
  context.print("its grid   sdfgrid sculpt --session {} --export OUT.vdb", folder);
  if (session.damaged) {
    context.warn(folder +
                 "/journal: it is damaged behind these records: open the session with "
                 "--resume --salvage to go on from them");
  } else if (session.torn) {
    context.warn(folder + "/journal: its last record is not complete and does not count");
  }
}

void report_strokes(const std::string& path, Context& context) {
  FileStamps stamps(context.job());
  const StrokeFile file = read_strokes(path, &stamps);
  for (const StrokeWarning& warning : file.warnings) context.warn(warning.text);
  for (const std::string& warning : stamps.warnings()) context.warn(warning);
  std::map<std::string, std::size_t> ops;
  std::vector<std::string> texts;
  Box box;
  for (const Stroke& stroke : file.strokes) {
    ++ops[stroke.at_points ? "stamp" : std::string(stroke_op_word(stroke.op))];
    texts.push_back(stroke.text);
    for (const PathPoint& point : stroke.path) box.add(point.at);
  }
  Json& result = context.result();
  result["kind"] = "strokes";
  report_bounds(box, context);  // of the paths
  result["strokes"] = file.strokes.size();
  result["ops"] = ops;
  result["list"] = texts;
  std::vector<std::string> counts;
  for (const auto& [op, count] : ops) counts.push_back(fmt::format("{} {}", count, op));
  context.print("strokes    {}{}{}", file.strokes.size(), counts.empty() ? "" : ": ",
                fmt::join(counts, ", "));
  print_strokes(texts, context);
  context.print("apply      sdfgrid sculpt GRID.vdb --strokes {} -o OUT.vdb", path);
}

}  // namespace sdfgrid::cli
