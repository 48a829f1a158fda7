#include "sdfgrid/edit/session_records.h"

#include <fmt/format.h>

#include <charconv>
#include <memory>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/stroke_file.h"

namespace sdfgrid {
namespace {

[[noreturn]] void refuse_newer(const std::string& journal, std::size_t number,
                               const std::string& problem) {
  throw input_error(journal, fmt::format("record {}", number),
                    problem + ": a newer version of sdfgrid made it",
                    "open the session with the version that made it");
}

// Stands in for all stamps, where only words are looked at.
class NoStamps : public StampMaker {
 public:
  std::shared_ptr<const BrushShape> brush(const Stamp& /*stamp*/) override {
    asked_ = true;
    return std::make_shared<BrushShape>();
  }
  Field field(const Stamp& /*stamp*/) override {
    asked_ = true;
    return make_field("sphere", {{"radius", 1.0}}, {});
  }
  std::string name(const Stamp& stamp) override { return stamp.file; }
  std::string keep(const Stamp& stamp, const std::string& /*folder*/) override {
    return stamp.file;
  }
  [[nodiscard]] bool asked() const { return asked_; }

 private:
  bool asked_ = false;
};

// A file of that one stroke: only of files words that are not known are told.
StrokeFile read_one(const std::string& text, const std::string& source, const StampSource& stamps) {
  return parse_strokes("{sdfgrid-strokes: 1, strokes: [" + text + "]}", source, stamps);
}

std::optional<std::string> unknown_word(const StrokeFile& read) {
  for (const StrokeWarning& warning : read.warnings) {
    if (warning.kind == StrokeWarning::Kind::unknown_word) return warning.text;
  }
  return std::nullopt;
}

// What is not understood of a text, whatever its stamps are.
std::optional<std::string> not_understood(const std::string& text) {
  NoStamps none;
  try {
    return unknown_word(read_one(text, "stroke", {&none, "", false}));
  } catch (const Error& e) {
    return e.what();
  }
}

}  // namespace

const char* redistance_word(Redistance redistance) {
  switch (redistance) {
    case Redistance::off:
      return "off";
    case Redistance::local:
      return "local";
    case Redistance::full:
      break;
  }
  return "full";
}

std::string start_text(const SessionStart& start) {
  const IndexBox& r = start.range;
  return fmt::format("session 1 {} {:016x} {} {} {} {} {} {}", redistance_word(start.redistance),
                     start.base_hash, r.lo.x, r.lo.y, r.lo.z, r.hi.x, r.hi.y, r.hi.z);
}

SessionStart read_start(const std::string& text, const std::string& journal) {
  std::istringstream in(text);
  std::string word;
  std::string version;
  std::string redistance;
  SessionStart start;
  IndexBox& r = start.range;
  in >> word >> version >> redistance >> std::hex >> start.base_hash >> std::dec >> r.lo.x >>
      r.lo.y >> r.lo.z >> r.hi.x >> r.hi.y >> r.hi.z;
  const bool read = static_cast<bool>(in);
  for (const Redistance mode : kRedistances) {
    if (redistance != redistance_word(mode)) continue;
    start.redistance = mode;
    // Said anew it must be the same: there was nothing more in it.
    if (read && text == start_text(start)) return start;
  }
  refuse_newer(journal, 0, "the session is of a kind that this program does not know");
}

SessionRecord read_record(const std::string& text, std::size_t number, const std::string& journal) {
  constexpr std::string_view kStroke = "stroke ";
  if (text.starts_with(kStroke)) {
    return {SessionRecord::Kind::stroke, text.substr(kStroke.size()), 0};
  }
  const bool undo = text.starts_with("undo ");
  if (undo || text.starts_with("redo ")) {
    std::size_t count = 0;
    const char* end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data() + 5, end, count);
    if (error == std::errc() && at == end) {
      return {undo ? SessionRecord::Kind::undo : SessionRecord::Kind::redo, "", count};
    }
  }
  refuse_newer(journal, number,
               fmt::format("this program does not know what '{}' is",
                           text.size() > 40 ? text.substr(0, 40) + "..." : text));
}

Stroke read_recorded_stroke(const std::string& text, std::size_t number, const std::string& journal,
                            const StampSource& stamps) {
  try {
    StrokeFile read = read_one(text, fmt::format("{}: record {}", journal, number), stamps);
    if (!unknown_word(read) && read.strokes.size() == 1) return std::move(read.strokes.front());
  } catch (const Error&) {
    if (!not_understood(text)) throw;  // its stamps are at fault
  }
  refuse_newer(journal, number,
               fmt::format("its stroke is not understood ({})",
                           not_understood(text).value_or("it is more than one")));
}

void check_recordable(const std::string& text) {
  NoStamps none;
  std::optional<std::string> unknown;
  try {
    unknown = unknown_word(read_one(text, "its text", {&none, "", false}));
  } catch (const Error& e) {
    if (none.asked()) return;  // what takes the place of the stamps may not fit where they do
    throw Error(ErrorKind::usage, e.what());
  }
  if (!unknown) return;
  throw Error(ErrorKind::usage, *unknown +
                                    "; a session does not record what it does not understand: "
                                    "mend the word or take it out");
}

void StandingStrokes::follow(const SessionRecord& record, std::size_t number) {
  if (record.kind == SessionRecord::Kind::stroke) {
    done.push_back(number);
    undone.clear();
    return;
  }
  const bool undo = record.kind == SessionRecord::Kind::undo;
  std::vector<std::size_t>& from = undo ? done : undone;
  std::vector<std::size_t>& to = undo ? undone : done;
  for (std::size_t count = record.count; count > 0 && !from.empty(); --count) {
    to.push_back(from.back());
    from.pop_back();
  }
}

}  // namespace sdfgrid
