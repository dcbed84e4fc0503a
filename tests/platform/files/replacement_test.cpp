#include "files/replacement.hpp"

#include "files/error.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <memory>

namespace replacement_test {

using sonopose::files::Replacement;
using sonopose::files::write_whole;
using sonopose::test::read_text;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;
namespace fs = std::filesystem;

SCENARIO("a file keeps its content until its replacement is complete") {
  const TemporaryFolder folder;
  const fs::path file = folder / "result.csv";
  write_text(file, "old");
  GIVEN("a replacement that is being written") {
    auto replacement = std::make_unique<Replacement>(file);
    write_text(replacement->part(), "new");
    CHECK(replacement->part() == folder / "result.csv.part");
    CHECK(read_text(file) == "old");
    WHEN("it is committed") {
      replacement->commit();
      THEN("it replaces the file, and nothing is left over") {
        CHECK(read_text(file) == "new");
        CHECK_FALSE(exists(folder / "result.csv.part"));
        replacement.reset();
        CHECK(read_text(file) == "new");
      }
    }
    WHEN("it is abandoned") {
      replacement.reset();
      THEN("the file is unchanged, and nothing is left over") {
        CHECK(read_text(file) == "old");
        CHECK_FALSE(exists(folder / "result.csv.part"));
      }
    }
    WHEN("the part has disappeared") {
      fs::remove(replacement->part());
      THEN("that is an error, and the file is unchanged") {
        CHECK_THROWS_WITH(replacement->commit(), Catch::Contains("result.csv: cannot be replaced"));
        CHECK(read_text(file) == "old");
      }
    }
  }
}

SCENARIO("a link stays a link, and a special file is written directly") {
  const TemporaryFolder folder;
  write_text(folder / "real.csv", "old");
  fs::create_symlink("real.csv", folder / "link.csv");
  Replacement linked(folder / "link.csv");
  write_text(linked.part(), "new");
  linked.commit();
  CHECK(fs::is_symlink(folder / "link.csv"));
  CHECK(read_text(folder / "real.csv") == "new");

  Replacement device("/dev/null");
  CHECK(device.part() == "/dev/null");
  device.commit();
  CHECK(fs::is_character_file("/dev/null"));
}

TEST_CASE("a text replaces a file as a whole or not at all") {
  const TemporaryFolder folder;
  write_text(folder / "a.toml", "something much longer than what comes");
  write_whole(folder / "a.toml", "short\n");
  CHECK(read_text(folder / "a.toml") == "short\n");
  CHECK_THROWS_AS(write_whole(folder / "none/a.toml", "x"), sonopose::files::IoError);
}

}  // namespace replacement_test
