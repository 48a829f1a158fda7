// edit/session_records.h: what the records of a session's journal say. The first is how the session
// began, the others are strokes, and undos and redos of some of them:
//
//   session 1 REDISTANCE HASH-OF-BASE LO.x LO.y LO.z HI.x HI.y HI.z
//   stroke TEXT
//   undo COUNT
//   redo COUNT
//
// Records are checked by their hashes before they come here, so one that is not understood was
// written by a program that knows more, and is refused: what it did must not be left out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/edit/stamp.h"

namespace sdfgrid {

struct SessionStart {
  Redistance redistance = Redistance::local;
  std::uint64_t base_hash = 0;  // of the file base.vdb
  IndexBox range;               // SculptOptions::range
};

[[nodiscard]] std::string start_text(const SessionStart& start);
// `journal` is what messages call the file. These throw Error{input} for what is not understood.
[[nodiscard]] SessionStart read_start(const std::string& text, const std::string& journal);

struct SessionRecord {
  enum class Kind { stroke, undo, redo };
  Kind kind = Kind::stroke;
  std::string stroke;     // its text
  std::size_t count = 0;  // of undone or redone ones
};

[[nodiscard]] SessionRecord read_record(const std::string& text, std::size_t number,
                                        const std::string& journal);

// The stroke of a record's text, which every word must be known of.
[[nodiscard]] Stroke read_recorded_stroke(const std::string& text, std::size_t number,
                                          const std::string& journal, const StampSource& stamps);
// Throws Error{usage} for a text with words that are not known: it would not be read again.
void check_recordable(const std::string& text);

// The numbers of the records of the strokes that stand, and of those that can be redone.
struct StandingStrokes {
  std::vector<std::size_t> done;
  std::vector<std::size_t> undone;  // the next to be redone last

  void follow(const SessionRecord& record, std::size_t number);
};

inline constexpr Redistance kRedistances[] = {Redistance::off, Redistance::local, Redistance::full};
[[nodiscard]] const char* redistance_word(Redistance redistance);

}  // namespace sdfgrid
