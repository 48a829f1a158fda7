// Malformed files of every kind in every format: refused with the file, a place and a remedy.
#include <gtest/gtest.h>

#include <limits>

#include "mesh/mesh_files.h"
#include "mesh/om_files.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/read.h"

namespace sdfgrid {
namespace {

using namespace testing;

// The message with which a file is refused; empty if it is read.
std::string refusal_of(const std::string& path) {
  try {
    (void)read_mesh(path, Job());
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    return error.what();
  }
}

struct Refused {
  std::string name, bytes;
  std::string place, problem;  // parts of the message
};

void expect_refused(const Refused& refused) {
  SCOPED_TRACE(refused.name + ": " + refused.problem);
  const TempDir folder;
  const std::string path = folder.write(refused.name, refused.bytes);
  const std::string message = refusal_of(path);
  EXPECT_TRUE(message.starts_with(path + ": " + refused.place)) << message;
  EXPECT_NE(message.find(refused.problem), std::string::npos) << message;
  EXPECT_NE(message.find("; "), std::string::npos) << "no remedy in: " << message;
}

template <class T>
std::string replaced(std::string bytes, std::size_t at, T value,
                     std::endian order = std::endian::little) {
  return bytes.replace(at, sizeof(T), bytes_of(value, order));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

const float kNan = std::numeric_limits<float>::quiet_NaN();
const PolygonMesh kCube = unit_cube();

std::vector<NamedFile> every_variant() {
  std::vector<NamedFile> files = all_variants(kCube);
  files.push_back({"float.om", "OM", om_bytes(kCube, false)});
  return files;
}

TEST(RefusedMesh, Missing) {
  EXPECT_EQ(refusal_of("/nowhere/a.obj"), "/nowhere/a.obj: there is no such file; check the path");
}

TEST(RefusedMesh, Folder) {
  const TempDir folder;
  std::filesystem::create_directory(folder.path("a.obj"));
  EXPECT_NE(refusal_of(folder.path("a.obj")).find("it is a folder"), std::string::npos);
}

TEST(RefusedMesh, UnknownExtension) {
  expect_refused({"a.vrml", obj_text(kCube), "name", "'.vrml' is not the extension of a mesh"});
  expect_refused({"mesh", obj_text(kCube), "name", "'' is not the extension of a mesh"});
}

TEST(RefusedMesh, Empty) {
  for (const NamedFile& file : every_variant()) {
    expect_refused({file.name, "", "byte 0", "the file is empty"});
  }
}

TEST(RefusedMesh, TextOfBlanks) {
  for (const char* name : {"a.obj", "a.off", "a.ply", "a.stl", "a.om"}) {
    expect_refused({name, "\n \n", "", ""});
  }
}

// Cut at any of these places, a file is refused, but for formats without an end where a cut may
// leave a whole mesh.
TEST(RefusedMesh, Truncated) {
  const TempDir folder;
  for (const NamedFile& file : every_variant()) {
    SCOPED_TRACE(file.name);
    // The last number of a text may lose digits unnoticed, and OM ends in chunks nobody needs.
    std::size_t last = file.bytes.size() - 1;
    if (file.format == "PLY text" || file.format == "OFF") last -= 2;
    if (file.format == "STL text") last = file.bytes.rfind("endsolid") + 7;
    if (file.format == "OM") last = file.bytes.size() * 3 / 4;
    if (file.format == "OBJ") last = file.bytes.find("\nf ") + 2;
    for (std::size_t size = 0; size < last; size += 7) {
      const std::string message = refusal_of(folder.write(file.name, file.bytes.substr(0, size)));
      ASSERT_FALSE(message.empty()) << "cut to " << size << " of " << file.bytes.size();
    }
  }
}

TEST(RefusedMesh, TruncatedObjInTheMiddleOfAFace) {
  expect_refused({"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2", "line 5", "the file ends"});
  expect_refused({"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1", "line 3", "the file ends"});
}

TEST(RefusedMesh, IndicesOutOfRange) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_refused({"a.obj", three + "f 1 2 4\n", "line 4", "index 4 is out of range: there are 3"});
  expect_refused({"a.obj", three + "f 0 1 2\n", "line 4", "index 0 is out of range"});
  expect_refused({"a.obj", three + "f -4 1 2\n", "line 4", "index -4 is out of range"});
  expect_refused({"a.obj", three + "\nf 1 2 99999999999\n", "line 5", "out of range"});
  expect_refused({"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "line 6",
                  "index 3 is out of range: the file has 3 points"});
  expect_refused({"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "line 6", "index -1"});
  const std::string off = off_binary(kCube, std::endian::little);
  expect_refused({"b.off", replaced(off, off.size() - 4, 8U),
                  "byte " + std::to_string(off.size() - 4), "index 8 is out of range"});
  expect_refused({"a.ply", replaced(ply_text(kCube), "4 0 2 3 1", "4 0 2 3 8"), "line 22",
                  "index 8 is out of range"});
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::string ply = ply_binary<float>(kCube, order);
    expect_refused({"b.ply", replaced(ply, ply.size() - 5, -1, order),
                    "byte " + std::to_string(ply.size() - 5), "index -1 is out of range"});
  }
}

// Past the header (16 bytes), points and normals (2 + 96 each), and a chunk's own 2 bytes, the
// cube's half-edges have a byte each for the next one, the point and the face.
TEST(RefusedMesh, HalfEdgesOutOfRange) {
  const std::string om = om_bytes(kCube, false);
  expect_refused({"a.om", replaced(om, 215, std::int8_t{99}), "face", "index 99 is out of range"});
  expect_refused(
      {"a.om", replaced(om, 214, std::int8_t{99}), "face", "half-edge 99 is out of range"});
  expect_refused(
      {"a.om", replaced(om, 214, std::int8_t{0}), "face", "runs into half-edge 0 again"});
}

TEST(RefusedMesh, CoordinatesThatAreNotFinite) {
  for (const char* word : {"nan", "-inf", "1e999", "NaN", "infinity"}) {
    const std::string point = std::string("0 ") + word + " 0\n";
    expect_refused({"a.obj", "v 0 0 0\nv 1 0 0\nv " + point + "f 1 2 3\n", "line 3", "not finite"});
    expect_refused(
        {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n" + point + "3 0 1 2\n", "line 5", "not finite"});
    expect_refused({"a.ply",
                    replaced(ply_text(kCube), "1 0 0 255", std::string("1 ") + word + " 0 255"),
                    "line 15", "not finite"});
    expect_refused({"a.stl", replaced(stl_text(kCube), "vertex 0 0 0", "vertex 0 " + point),
                    "line 4", "not finite"});
  }
  const std::string stl = stl_binary(kCube);
  expect_refused({"b.stl", replaced(stl, 100, kNan), "byte 100", "not finite"});
  const std::string off = off_binary(kCube, std::endian::little);
  expect_refused({"b.off", replaced(off, 27, kNan), "byte 27", "not finite"});
  const std::string ply = ply_binary<float>(kCube, std::endian::big);
  const std::size_t data = ply.find("end_header\n") + 11;
  expect_refused({"b.ply", replaced(ply, data + 4, kNan, std::endian::big),
                  "byte " + std::to_string(data + 4), "not finite"});
  expect_refused({"a.om", replaced(om_bytes(kCube, false), 18 + 4, kNan), "byte 22", "not finite"});
}

// None of these may allocate what it announces.
TEST(RefusedMesh, AbsurdCounts) {
  expect_refused(
      {"a.off", "OFF\n4000000000 1 0\n0 0 0\n", "line 2", "4000000000 points and 1 face"});
  expect_refused({"a.off", "OFF\n1 99999999999999 0\n0 0 0\n", "line 2", "are announced"});
  expect_refused({"a.off", "OFF\n-3 1 0\n0 0 0\n", "line 2", "expected the number of points"});
  expect_refused({"a.off", "OFF\n1 1 0\n0 0 0\n2000000000 0 0 0\n", "line 4", "does not fit"});
  expect_refused({"b.off", replaced(off_binary(kCube, std::endian::little), 11, 0xf0f0f0f0U),
                  "header", "are announced"});
  expect_refused({"a.ply", replaced(ply_text(kCube), "vertex 8", "vertex 888888888888"), "header",
                  "888888888888 elements 'vertex' are announced"});
  expect_refused(
      {"b.ply",
       replaced(ply_binary<float>(kCube, std::endian::little), "face 6", "face 4294967295"),
       "header", "4294967295 elements 'face'"});
  expect_refused({"c.ply",
                  replaced(ply_binary<float>(kCube, std::endian::little), "comment made",
                           "element a 99999\nproperty int b\ncomment "),
                  "header", "99999 elements 'a'"});
  expect_refused({"b.stl", replaced(stl_binary(kCube), 80, 0xffffffffU), "byte 80",
                  "4294967295 triangles announced make 214748364834 bytes"});
  const std::string om = om_bytes(kCube, false);
  for (const std::size_t at : {4, 8, 12}) {
    expect_refused({"a.om", replaced(om, at, 0xf0f0f0f0U), "byte", "the header announces"});
  }
}

TEST(RefusedMesh, NoSurface) {
  expect_refused({"a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "end", "2 points but no faces"});
  expect_refused({"b.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "end", "no face has three corners"});
  expect_refused({"a.off", "OFF\n1 0 0\n0 0 0\n", "end", "1 point but no faces"});
  expect_refused({"a.ply",
                  "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                  "property float z\nend_header\n0 0 0\n",
                  "header", "there is no element 'face'"});
  expect_refused({"a.stl", "solid none\nendsolid none\n", "end", "there are no points"});
  expect_refused({"b.stl", std::string(84, '\0'), "end", "there are no points"});
}

TEST(RefusedMesh, Malformed) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_refused({"a.obj", three + "f 1 2 x\n", "line 4", "expected a point's index, found 'x'"});
  expect_refused({"a.obj", three + "f 1 2 /3\n", "line 4", "expected a point's index"});
  expect_refused({"a.obj", "v 0 0\n" + three, "line 1", "a coordinate is missing"});
  expect_refused({"a.obj", "v 0 0,5 0\n", "line 1", "expected a coordinate, found '0,5'"});
  expect_refused({"a.off", "4OFF\n1 1 0\n0 0 0 1\n", "line 1", "more than 3 coordinates"});
  expect_refused({"a.off", "COFF BINARY\nxxxxxxxxxxxx", "line 1", "a binary OFF with attributes"});
  const std::string ply = ply_text(kCube);
  expect_refused({"a.ply", replaced(ply, "ascii", "utf8"), "line 2", "unknown encoding 'utf8'"});
  expect_refused({"a.ply", replaced(ply, "double x", "half x"), "line 6", "unknown type 'half'"});
  expect_refused({"a.ply", replaced(ply, "double x", "double w"), "header", "no coordinate 'x'"});
  expect_refused(
      {"a.ply", replaced(ply, "vertex_indices", "indices"), "header", "no list 'vertex_indices'"});
  expect_refused(
      {"a.ply", replaced(ply, "end_header", "the_end"), "header", "no line 'end_header'"});
  expect_refused(
      {"a.ply", replaced(ply, "4 0 2 3 1", "-4 0 2 3 1"), "line 22", "a list of -4 items"});
  expect_refused({"a.stl", replaced(stl_text(kCube), "endloop", "vertex 1 2 3\nendloop"), "line 7",
                  "expected 'endloop', found 'vertex'"});
  expect_refused({"a.om", replaced(om_bytes(kCube, false), 2, 'X'), "byte 2", "unknown kind"});
  expect_refused(
      {"a.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n", "bounds", "larger than 1e18"});
}

// Each file under the name of each other format.
TEST(RefusedMesh, WrongExtension) {
  for (const NamedFile& file : every_variant()) {
    for (const std::string extension : {".obj", ".off", ".ply", ".stl", ".om"}) {
      if (file.name.ends_with(extension)) continue;
      expect_refused({"wrong" + extension, file.bytes, "", ""});
    }
  }
}

TEST(RefusedMesh, Garbage) {
  std::string garbage;
  std::uint32_t state = 1;
  for (int i = 0; i < 4096; ++i) {
    state = state * 1664525U + 1013904223U;
    garbage += static_cast<char>(state >> 24U);
  }
  for (const NamedFile& file : every_variant()) {
    expect_refused({file.name, garbage, "", ""});
    expect_refused({file.name, file.bytes.substr(0, 3) + garbage, "", ""});
  }
}

}  // namespace
}  // namespace sdfgrid
