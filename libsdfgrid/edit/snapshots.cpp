#include "sdfgrid/edit/snapshots.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "snapshot-";
constexpr std::string_view kExtension = ".vdb";
constexpr std::size_t kKept = 2;

std::string name_of(const Snapshot& snapshot) {
  return fmt::format("{}{}-{:016x}-{:016x}{}", kPrefix, snapshot.records, snapshot.journal,
                     snapshot.contents, kExtension);
}

// Takes a number and what stands behind it from the beginning.
template <class T>
bool take(std::string_view& in, int base, char behind, T& value) {
  const auto [end, error] = std::from_chars(in.data(), in.data() + in.size(), value, base);
  if (error != std::errc() || end == in.data() + in.size() || *end != behind) return false;
  in.remove_prefix(static_cast<std::size_t>(end - in.data()) + 1);
  return true;
}

bool read_name(const std::string& name, Snapshot& snapshot) {
  if (!name.starts_with(kPrefix)) return false;
  std::string_view rest = std::string_view(name).substr(kPrefix.size());
  return take(rest, 10, '-', snapshot.records) && take(rest, 16, '-', snapshot.journal) &&
         take(rest, 16, '.', snapshot.contents) && name == name_of(snapshot);
}

void remove_unfinished(const fs::path& folder) {
  std::error_code none;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (is_unfinished(entry.path().filename().string())) found.push_back(entry.path());
  }
  for (const fs::path& path : found) fs::remove(path, none);
}

}  // namespace

bool is_unfinished(const std::string& name) {
  return name.starts_with('.') && name.find(".partial-") != std::string::npos;
}

std::vector<Snapshot> find_snapshots(const std::string& folder) {
  std::vector<Snapshot> all;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    Snapshot snapshot;
    if (!read_name(entry.path().filename().string(), snapshot)) continue;
    snapshot.path = entry.path().string();
    all.push_back(snapshot);
  }
  std::sort(all.begin(), all.end(), [](const Snapshot& a, const Snapshot& b) {
    return a.records != b.records ? a.records > b.records : a.path < b.path;
  });
  return all;
}

Grid read_snapshot(const Snapshot& snapshot) {
  if (fnv_hash_of_file(snapshot.path) != snapshot.contents) {
    throw input_error(snapshot.path, "", "it is not what was written", "delete it");
  }
  return read_grid(snapshot.path);
}

void write_snapshot(const Grid& grid, const std::string& folder, std::size_t records,
                    std::uint64_t journal) {
  // The name needs the contents, so it comes last; until then it is an unfinished file.
  const std::string unfinished = folder + "/.snapshot.partial-new.vdb";
  write_grid(grid, unfinished);
  const Snapshot snapshot{"", records, journal, fnv_hash_of_file(unfinished)};
  std::error_code failed;
  fs::rename(unfinished, folder + "/" + name_of(snapshot), failed);
  if (failed) throw Error(ErrorKind::failed, unfinished + ": " + failed.message());
}

bool is_of(const Snapshot& snapshot, const std::vector<JournalRecord>& records) {
  return snapshot.records > 0 && snapshot.records <= records.size() &&
         snapshot.journal == records[snapshot.records - 1].hash;
}

void remove_leftovers(const std::string& folder, const std::vector<JournalRecord>& records) {
  remove_unfinished(folder);
  remove_unfinished(folder + "/stamps");
  std::error_code none;
  std::size_t kept = 0;
  for (const Snapshot& snapshot : find_snapshots(folder)) {
    if (!is_of(snapshot, records) || ++kept > kKept) fs::remove(snapshot.path, none);
  }
}

}  // namespace sdfgrid
