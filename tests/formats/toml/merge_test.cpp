#include "toml/merge.hpp"

#include "support/temporary_folder.hpp"
#include "toml/leaves.hpp"

#include <catch2/catch.hpp>

#include <vector>

namespace merge_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using toml::Assignment;

const std::vector<Assignment> assignments{{"heading", "mount_offset_deg", "84.5", "+- 0.2 deg"},
                                          {"delay", "correction_s", "-0.012", ""}};

SCENARIO("merging changes only the lines of its values") {
  const TemporaryFolder folder;
  const auto file = folder / "fusion.toml";
  GIVEN("a file with comments, one of the values, and a table for the other one") {
    write_text(file,
               "# mine\n[heading]  # of the pair\nmount_offset_deg = 90.0 # guessed\n\n[delay]\nprocessing_s "
               "= 0.07\n");
    WHEN("values are merged") {
      toml::merge(file, assignments);
      THEN("everything else is as it was") {
        CHECK(read_text(file) ==
              "# mine\n[heading]  # of the pair\nmount_offset_deg = 84.5  # +- 0.2 deg\n\n[delay]\n"
              "correction_s = -0.012\nprocessing_s = 0.07\n");
      }
    }
  }
  GIVEN("a file with the line ends of Windows and a byte order mark") {
    write_text(file, "\xEF\xBB\xBF[heading]\r\nmount_offset_deg = 90.0\r\n# mine");
    WHEN("values are merged") {
      toml::merge(file, assignments);
      THEN("its lines end as before, also the new ones") {
        CHECK(read_text(file) ==
              "\xEF\xBB\xBF[heading]\r\nmount_offset_deg = 84.5  # +- 0.2 deg\r\n# mine\r\n"
              "\r\n[delay]\r\ncorrection_s = -0.012\r\n");
      }
    }
  }
  GIVEN("no file") {
    toml::merge(file, assignments);
    THEN("there is one with the values") {
      const auto leaves = toml::read_leaves(file);
      REQUIRE(leaves.size() == 2);
      CHECK(leaves[0].key == "delay.correction_s");
      CHECK(std::get<double>(leaves[0].value) == -0.012);
      CHECK(leaves[1].key == "heading.mount_offset_deg");
    }
  }
}

SCENARIO("a file is refused by its size before it is read") {
  const TemporaryFolder folder;
  const auto file = folder / "huge.toml";
  GIVEN("a file of 20 MB") {
    write_text(file, "a = 1\n");
    std::filesystem::resize_file(file, 20'000'000);
    THEN("the error names file, size and limit") {
      CHECK_THROWS_WITH(toml::read_leaves(file),
                        file.string() + ": has 20000000 bytes, the limit of a TOML file is 16777216");
    }
  }
}

SCENARIO("a file that cannot be merged stays as it is") {
  const TemporaryFolder folder;
  const auto file = folder / "fusion.toml";
  for (const char* const text :
       {"heading = { mount_offset_deg = 90.0 }\n", "heading.mount_offset_deg = 90.0\n",
        "[heading]\nmount_offset_deg = = 1\n", "heading = { pair_gain_hz = 1.0 }\n"}) {
    GIVEN(text) {
      write_text(file, text);
      THEN("the error names it") {
        CHECK_THROWS_WITH(toml::merge(file, assignments), Contains("fusion.toml"));
        CHECK(read_text(file) == text);
      }
    }
  }
}

}  // namespace merge_test
