#include "sdfgrid/core/words.h"

#include <gtest/gtest.h>

namespace sdfgrid {
namespace {

TEST(EditDistance, CountsTheFewestChanges) {
  EXPECT_EQ(edit_distance("", ""), 0U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("abc", ""), 3U);
  EXPECT_EQ(edit_distance("dim", "dim"), 0U);
  EXPECT_EQ(edit_distance("dmi", "dim"), 1U);  // a swap is one mistake
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("sitting", "kitten"), 3U);
}

TEST(NearestWord, IsTheNearestOrNone) {
  const std::vector<std::string> words = {"convert", "compare", "render"};
  EXPECT_EQ(nearest_word("convrt", words), "convert");
  EXPECT_EQ(nearest_word("compar", words), "compare");
  EXPECT_EQ(nearest_word("renderer", words), "render");
  EXPECT_EQ(nearest_word("xyzzy", words), "");
  EXPECT_EQ(nearest_word("", words), "");
  EXPECT_EQ(nearest_word("abc", {}), "");
}

// A short word must not be answered with one that shares no letter with it.
TEST(NearestWord, ShortWordsMustShareALetter) {
  EXPECT_EQ(nearest_word("-q", {"-o", "--threads"}), "-o");
  EXPECT_EQ(nearest_word("zz", {"ab"}), "");
}

}  // namespace
}  // namespace sdfgrid
