// NRRD files made by hand after the format's definition (teem.sourceforge.net/nrrd/format.html).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "volume/volumes.h"

namespace sdfgrid {
namespace {

using namespace testing;

constexpr const char* kHead = "NRRD0004\n# made by hand\ntype: short\ndimension: 3\nsizes: 5 4 3\n";

std::string samples(std::endian order = std::endian::little) {
  return sample_bytes<std::int16_t>(pattern_volume<std::int16_t>(), order);
}

class Nrrd : public ::testing::Test {
 protected:
  TempDir folder_;

  Volume read_text(const std::string& bytes) { return read(folder_.write("a.nrrd", bytes)).volume; }

  void expect_refused(const std::string& bytes, const std::string& part) {
    const std::string message = refusal(folder_.write("bad.nrrd", bytes));
    EXPECT_NE(message.find("bad.nrrd"), std::string::npos) << part;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
};

TEST_F(Nrrd, RawInBothByteOrders) {
  const std::string head = kHead;
  EXPECT_TRUE(holds_pattern(read_text(head + "endian: little\nencoding: raw\n\n" + samples())));
  EXPECT_TRUE(holds_pattern(
      read_text(head + "endian: big\nencoding: raw\n\n" + samples(std::endian::big))));
}

TEST_F(Nrrd, GzipAndText) {
  const std::string head = kHead;
  const VolumeFile file = read(folder_.write(
      "z.nrrd", head + "endian: big\nencoding: gzip\n\n" + gzip(samples(std::endian::big))));
  EXPECT_TRUE(holds_pattern(file.volume));
  EXPECT_EQ(file.format, "NRRD gzip");
  EXPECT_EQ(type_name(file.volume.samples), "int16");
  std::string text;
  const Volume volume = pattern_volume<std::int16_t>();
  for (const int v : std::get<std::vector<std::int16_t>>(volume.samples)) {
    text += fmt::format("{} ", v);
  }
  EXPECT_TRUE(holds_pattern(read_text(head + "encoding: ascii\n\n" + text)));
}

TEST_F(Nrrd, DetachedFilesOneOrMany) {
  const std::string head = std::string(kHead) + "endian: little\nencoding: raw\n";
  (void)folder_.write("data.raw", "skip" + samples());
  const std::string one = folder_.write("one.nhdr", head + "byte skip: 4\ndata file: data.raw\n");
  EXPECT_TRUE(holds_pattern(read(one).volume));
  for (int k = 0; k < 3; ++k)
    (void)folder_.write(fmt::format("s{}.raw", k), samples().substr(40 * k, 40));
  EXPECT_TRUE(holds_pattern(
      read(folder_.write("list.nhdr", head + "data file: LIST\ns0.raw\ns1.raw\ns2.raw\n")).volume));
  EXPECT_TRUE(
      holds_pattern(read(folder_.write("many.nhdr", head + "data file: s%d.raw 0 2 1\n")).volume));
}

TEST_F(Nrrd, PlaceAndOrientationAreKept) {
  const std::string data = "endian: little\nencoding: raw\n";
  const Volume turned =
      read_text(std::string(kHead) + data +
                "space: left-posterior-superior\n"
                "space directions: (0,2,0) (-0.5,0,0) (0,0,3)\nspace origin: (10,-20,30)\n\n" +
                samples());
  EXPECT_EQ(turned.spacing, glm::dvec3(2, 0.5, 3));
  EXPECT_EQ(turned.origin, glm::dvec3(10, -20, 30));
  EXPECT_EQ(turned.to_world({1, 1, 1}), glm::dvec3(9.5, -18, 33));
  EXPECT_FALSE(turned.axis_aligned());
  EXPECT_TRUE(turned.orthogonal());

  const Volume spaced = read_text(std::string(kHead) + data + "spacings: 0.5 1 2\n\n" + samples());
  EXPECT_EQ(spaced.spacing, glm::dvec3(0.5, 1, 2));
  EXPECT_TRUE(spaced.axis_aligned());

  // Five cells of two units, the first centre one unit from the border.
  const Volume cells = read_text(std::string(kHead) + data +
                                 "axis mins: 10 0 0\naxis maxs: 20 4 3\n"
                                 "centers: cell cell cell\n\n" +
                                 samples());
  EXPECT_EQ(cells.spacing, glm::dvec3(2, 1, 1));
  EXPECT_EQ(cells.origin, glm::dvec3(11, 0.5, 0.5));
}

TEST_F(Nrrd, OneVolumeOfASeriesOfOne) {
  const Volume volume = read_text(
      "NRRD0004\ntype: short\ndimension: 4\nsizes: 1 5 4 3\nendian: little\nencoding: raw\n\n" +
      samples());
  EXPECT_TRUE(holds_pattern(volume));
}

TEST_F(Nrrd, MalformedOnesAreRefused) {
  const std::string head = std::string(kHead) + "endian: little\nencoding: raw\n\n";
  expect_refused("", "empty");
  expect_refused("NIFTI", "line 1");
  expect_refused("NRRD0004\ntype: short\n", "header");
  expect_refused(head + samples().substr(1), "announces 120 bytes");
  expect_refused(std::string(kHead) + "encoding: raw\n\n" + samples(), "endian");
  expect_refused("NRRD0004\ntype: wide\ndimension: 3\nsizes: 5 4 3\nencoding: raw\n\n", "header");
  expect_refused("NRRD0004\ntype: short\ndimension: 3\nsizes: 5 4 -3\nencoding: raw\n\n", "header");
  expect_refused(
      "NRRD0004\ntype: block\nblock size: 4\ndimension: 3\nsizes: 5 4 3\n"
      "endian: little\nencoding: raw\n\n" +
          samples(),
      "blocks");
  expect_refused(
      "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 5 4 3\nencoding: raw\n\n" + samples(),
      "4 axes");
  expect_refused(
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 90000 90000 90000\n"
      "encoding: raw\n\n" +
          samples(),
      "announces 729000000000000 bytes");
  expect_refused(std::string(kHead) + "endian: little\nencoding: raw\ndata file: gone.raw\n",
                 "gone.raw");
  const std::string packed = gzip(samples());
  expect_refused(std::string(kHead) + "endian: little\nencoding: gzip\n\n" +
                     packed.substr(0, packed.size() / 2),
                 "samples");
  expect_refused(
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 9000 9000 9000\n"
      "encoding: gzip\n\n" +
          packed,
      "compressed");
}

}  // namespace
}  // namespace sdfgrid
