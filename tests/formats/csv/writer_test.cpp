#include "csv/writer.hpp"

#include "files/error.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <limits>

namespace csv_writer_test {

using namespace sonopose;
using namespace sonopose::test;
using csv::Writer;

TEST_CASE("each kind of cell reads back unchanged") {
  const TemporaryFolder folder;
  {
    Writer rows(folder / "t.csv", Writer::Existing::refuse);
    const std::array<std::string_view, 3> columns{"time [ns]", "x [m]", "word"};
    rows.header(columns);
    rows.integer(-5).number(0.1).text("used|first").end_row();
    rows.empty().known_number(std::numeric_limits<double>::quiet_NaN()).known_number(2.0).end_row();
    rows.vector({1, -0.0, 1e300}).end_row();
  }
  CHECK(read_text(folder / "t.csv") == "#time [ns],x [m],word\n-5,0.1,used|first\n,,2\n1,-0,1e+300\n");
}

TEST_CASE("seconds are the exact nanoseconds, whichever side of the epoch") {
  const TemporaryFolder folder;
  {
    Writer rows(folder / "t.txt", Writer::Existing::refuse, ' ');
    for (const TimeNs time_ns : {TimeNs{1'700'000'000'000'000'001}, TimeNs{0}, TimeNs{-1},
                                 TimeNs{1'050'000'000}, std::numeric_limits<TimeNs>::min()}) {
      rows.seconds(time_ns).number(1.5).end_row();
    }
  }
  CHECK(read_text(folder / "t.txt") ==
        "1700000000.000000001 1.5\n0.000000000 1.5\n-0.000000001 1.5\n1.050000000 1.5\n"
        "-9223372036.854775808 1.5\n");
}

TEST_CASE("an existing file is refused or replaced, as asked") {
  const TemporaryFolder folder;
  write_text(folder / "t.csv", "something longer than what comes now\n");
  CHECK_THROWS_AS(Writer(folder / "t.csv", Writer::Existing::refuse), files::IoError);
  Writer(folder / "t.csv", Writer::Existing::replace).integer(1).end_row();
  CHECK(read_text(folder / "t.csv") == "1\n");
}

TEST_CASE("a write error names the file") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(Writer(folder / "none/t.csv", Writer::Existing::replace),
                    Catch::Contains("none/t.csv") && Catch::Contains("No such file"));
  Writer full("/dev/full", Writer::Existing::replace);
  full.integer(1).end_row();
  CHECK_THROWS_WITH(full.flush(), Catch::Contains("/dev/full") && Catch::Contains("No space left"));
}

}  // namespace csv_writer_test
