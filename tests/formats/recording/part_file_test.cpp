#include "recording/part_file.hpp"

#include "files/error.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace part_file_test {

using namespace sonopose;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;

TEST_CASE("A file has its name when it is complete, and none is overwritten") {
  const TemporaryFolder folder;
  const auto file = folder / "below/run.mcap";
  const recording::PartFile part(file);
  CHECK(part.part() == folder / "below/run.mcap.part");
  write_text(part.part(), "content");

  SECTION("it gets its name") {
    part.commit();
    CHECK(test::read_text(file) == "content");
    CHECK_FALSE(exists(part.part()));
    CHECK_THROWS_WITH(recording::PartFile(file),
                      Catch::EndsWith("run.mcap: exists; a recording is not overwritten"));
  }
  SECTION("another program has begun the same") {
    CHECK_THROWS_WITH(recording::PartFile(file),
                      Catch::Contains("run.mcap.part: exists: another program writes it"));
  }
  SECTION("a file of that name has appeared") {
    write_text(file, "of somebody else");
    CHECK_THROWS_AS(part.commit(), files::IoError);
    CHECK(test::read_text(file) == "of somebody else");
  }
  SECTION("there is no such folder, and none can be made") {
    write_text(folder / "plain", "");
    CHECK_THROWS_AS(recording::PartFile(folder / "plain/run.mcap"), files::IoError);
  }
}

}  // namespace part_file_test
