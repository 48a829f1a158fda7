// The order of the rooms and the place of the heavy packages, read from the sources themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

// In the order in which data flows: a room includes only itself and rooms before it.
const std::vector<std::string> kRooms = {"core",       "mesh",      "volume", "field",
                                         "voxelize",   "transform", "grid",   "edit",
                                         "polygonize", "trace",     "image",  "scene"};

// What is slow to compile or decides something for the whole project, and where alone it may stand:
// there in sources and in headers that are not installed.
struct HeavyPackage {
  std::string name;
  std::regex include;
  std::regex allowed_in;  // path within the project
};

const std::vector<HeavyPackage>& heavy_packages() {
  static const std::vector<HeavyPackage> packages = {
      {"OpenVDB", std::regex("(openvdb/|sdfgrid/grid/vdb\\.h).*"),
       std::regex("libsdfgrid/grid/.*")},
      {"OpenMesh", std::regex("OpenMesh/.*"), std::regex("libsdfgrid/mesh/.*")},
      {"OpenImageIO", std::regex("OpenImageIO/.*"), std::regex("libsdfgrid/image/.*")},
      {"NanoVDB", std::regex("nanovdb/.*"), std::regex("libsdfgrid/grid/.*")},
      {"teem", std::regex("teem/.*"), std::regex("libsdfgrid/volume/.*")},
      {"libnifti", std::regex("nifti/.*"), std::regex("libsdfgrid/volume/.*")},
      {"TBB", std::regex("(oneapi/)?tbb/.*|execution"),
       std::regex("libsdfgrid/core/parallel\\.cpp")},
      {"CGAL", std::regex("CGAL/.*"), std::regex("libsdfgrid/mesh/repair.*")},
      {"yaml-cpp", std::regex("yaml-cpp/.*"),
       std::regex("libsdfgrid/(scene/.*|edit/(stroke_file|yaml_checks)\\.cpp)")},
      {"CLI11", std::regex("CLI/.*"), std::regex("apps/.*")},
      {"JSON", std::regex("nlohmann/.*"), std::regex("apps/.*")},
      {"threads", std::regex("thread|future|pthread\\.h|omp\\.h"),
       std::regex("libsdfgrid/core/parallel\\.cpp|apps/sdfgrid/interrupt\\.(h|cpp)")},
  };
  return packages;
}

struct Source {
  std::string path;  // "libsdfgrid/grid/grid.h"
  std::vector<std::string> includes;
  bool installed = false;  // a header that is neither "(not installed)" nor "internal to" a room
};

Source read_source(const fs::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  Source source;
  source.path = fs::relative(file, SDFGRID_SOURCE_DIR).generic_string();
  static const std::regex include(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  for (std::string line; std::getline(text, line);) {
    std::smatch match;
    if (std::regex_search(line, match, include)) source.includes.push_back(match[1]);
  }
  const std::string all = text.str();
  const std::string opening = all.substr(0, all.find("#pragma once"));
  source.installed =
      file.extension() == ".h" &&
      !std::regex_search(opening, std::regex("not[ \n/]+installed|[Ii]nternal[ \n/]+to"));
  return source;
}

// All sources of the library and the application.
const std::vector<Source>& sources() {
  static const std::vector<Source> all = [] {
    std::vector<Source> found;
    for (const char* folder : {"libsdfgrid", "apps"}) {
      for (const auto& entry :
           fs::recursive_directory_iterator(fs::path(SDFGRID_SOURCE_DIR) / folder)) {
        const auto extension = entry.path().extension();
        if (extension == ".h" || extension == ".cpp") found.push_back(read_source(entry.path()));
      }
    }
    return found;
  }();
  return all;
}

// "libsdfgrid/grid/grid.h" and "sdfgrid/grid/grid.h" -> "grid"; "" for anything else.
std::string room_of(const std::string& path) {
  static const std::regex pattern("(lib)?sdfgrid/([^/]+)/.*");
  std::smatch match;
  return std::regex_match(path, match, pattern) ? match[2].str() : "";
}

std::ptrdiff_t rank(const std::string& room) {
  return std::find(kRooms.begin(), kRooms.end(), room) - kRooms.begin();
}

const Source* find_header(const std::string& include) {
  const std::string path = "lib" + include;
  const auto found = std::find_if(sources().begin(), sources().end(),
                                  [&](const Source& source) { return source.path == path; });
  return found == sources().end() ? nullptr : &*found;
}

TEST(IncludeGraph, ReadsTheSources) {
  EXPECT_GT(sources().size(), 30U);
  EXPECT_NE(find_header("sdfgrid/core/error.h"), nullptr);
}

TEST(IncludeGraph, EveryFolderOfTheLibraryIsARoom) {
  for (const auto& entry : fs::directory_iterator(fs::path(SDFGRID_SOURCE_DIR) / "libsdfgrid")) {
    if (!entry.is_directory()) continue;
    EXPECT_LT(rank(entry.path().filename().string()), std::ssize(kRooms)) << entry.path();
  }
}

TEST(IncludeGraph, RoomsIncludeOnlyRoomsBeforeThem) {
  for (const Source& source : sources()) {
    const std::string room = room_of(source.path);
    if (room.empty()) continue;
    for (const std::string& include : source.includes) {
      const std::string other = room_of(include);
      if (other.empty()) continue;
      EXPECT_LE(rank(other), rank(room)) << source.path << " includes " << include;
    }
  }
}

TEST(IncludeGraph, HeavyPackagesStayInTheirPlace) {
  for (const Source& source : sources()) {
    for (const std::string& include : source.includes) {
      for (const HeavyPackage& package : heavy_packages()) {
        if (!std::regex_match(include, package.include)) continue;
        EXPECT_TRUE(std::regex_match(source.path, package.allowed_in))
            << source.path << " includes " << include << " of " << package.name;
        EXPECT_TRUE(!source.installed || source.path == "libsdfgrid/grid/vdb.h" ||
                    source.path.starts_with("apps/"))
            << source.path << " is installed and includes " << include;
      }
    }
  }
}

TEST(IncludeGraph, InstalledHeadersAndTheApplicationIncludeOnlyInstalledHeaders) {
  for (const Source& source : sources()) {
    const bool of_app = source.path.starts_with("apps/");
    if (!of_app && !source.installed) continue;
    for (const std::string& include : source.includes) {
      if (room_of(include).empty()) continue;
      const Source* header = find_header(include);
      ASSERT_NE(header, nullptr) << source.path << " includes " << include;
      EXPECT_TRUE(header->installed) << source.path << " includes " << include;
    }
  }
}

TEST(IncludeGraph, HeadersSayWhatTheyAreForAndGuardThemselves) {
  for (const Source& source : sources()) {
    if (!source.path.ends_with(".h")) continue;
    std::ifstream in(fs::path(SDFGRID_SOURCE_DIR) / source.path);
    std::string first;
    std::getline(in, first);
    const std::string name = source.path.starts_with("libsdfgrid/")
                                 ? source.path.substr(std::string("libsdfgrid/").size())
                                 : source.path;
    EXPECT_TRUE(first.starts_with("// " + name + ": ")) << source.path << ": " << first;
    std::string text((std::istreambuf_iterator<char>(in)), {});
    EXPECT_NE(text.find("#pragma once"), std::string::npos) << source.path;
  }
}

}  // namespace
