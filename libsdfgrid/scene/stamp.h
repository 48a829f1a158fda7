// scene/stamp.h: grids and scenes as brushes of strokes, and the copies of them that sessions keep.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/edit/stamp.h"

namespace sdfgrid {

// Reads each file once, however often it is used. A scene is taken as it is at time 0; its camera
// and materials do not matter.
class FileStamps : public StampMaker {
 public:
  explicit FileStamps(const Job& job) : job_(job) {}  // keeps the reference

  // A grid's values are its trilinear field's, so that on its own lattice they are its samples.
  [[nodiscard]] std::shared_ptr<const BrushShape> brush(const Stamp& stamp) override;
  [[nodiscard]] Field field(const Stamp& stamp) override;
  [[nodiscard]] std::string name(const Stamp& stamp) override { return entry(stamp).name; }
  [[nodiscard]] std::string keep(const Stamp& stamp, const std::string& folder) override;

  // Of the scenes and meshes that were read.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Entry {
    std::string name;  // what a copy is called: the hash of its contents
    std::shared_ptr<const BrushShape> brush;
    std::unique_ptr<Field> field;
  };
  Entry& entry(const Stamp& stamp);
  [[nodiscard]] Field scene_field(const std::string& file);

  const Job& job_;

  std::map<std::string, Entry> entries_;  // by the stamp's file
  std::vector<std::string> warnings_;
};

}  // namespace sdfgrid
