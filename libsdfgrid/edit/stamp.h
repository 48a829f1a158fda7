// edit/stamp.h: files that brushes are made of: a grid or a scene. What such a file holds, and
// which other files it names, only a room below this one knows (scene/stamp.h); this one hands it
// over.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sdfgrid/edit/stroke.h"
#include "sdfgrid/field/field.h"

namespace sdfgrid {

// Makes brushes of stamps, and copies of them that last as long as a session does.
class StampMaker {
 public:
  StampMaker() = default;
  StampMaker(const StampMaker&) = delete;
  StampMaker& operator=(const StampMaker&) = delete;
  virtual ~StampMaker() = default;

  // The stamp as a brush, and as a part of one: its own origin follows the path. Throw Error{input}
  // with file and remedy for what is no such file, has no inside or no end, and for a kept stamp
  // whose contents are not those that were kept.
  [[nodiscard]] virtual std::shared_ptr<const BrushShape> brush(const Stamp& stamp) = 0;
  [[nodiscard]] virtual Field field(const Stamp& stamp) = 0;

  // What keep() would call the copy.
  [[nodiscard]] virtual std::string name(const Stamp& stamp) = 0;

  // Copies the stamp, with all files that it names, into `folder` (made if missing), under names
  // that are hashes of the contents, and returns the stamp's. When this returns the copies are on
  // the disk. Throws Error{failed}, also if the file changed since its brush was made.
  [[nodiscard]] virtual std::string keep(const Stamp& stamp, const std::string& folder) = 0;
};

// Who makes the brushes of stamps, and where relative paths begin.
struct StampSource {
  StampMaker* maker = nullptr;  // none: stamps are refused
  std::string folder;           // "" for the working directory
  bool kept = false;            // whether they are copies by keep()
};

}  // namespace sdfgrid
