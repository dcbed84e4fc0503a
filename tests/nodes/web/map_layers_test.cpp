#include "web/map_layers.hpp"

#include "files/error.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <limits>

namespace map_layers_test {

using namespace sonopose;
using namespace sonopose::web;
using Catch::Contains;

std::filesystem::path write(const test::TemporaryFolder& folder, const std::string& name,
                            const std::string& text) {
  std::ofstream(folder.path() / name, std::ios::binary) << text;
  return folder.path() / name;
}

SCENARIO("a floor plan is a picture with a place") {
  const test::TemporaryFolder folder;
  const auto plan = read_floor_plan(write(folder, "hall.png", "PNG"), {0, -1, 20, 10.5});
  CHECK(plan.picture.content_type == "image/png");
  CHECK(*plan.picture.body == "PNG");
  CHECK(nlohmann::json::parse(json_of({.floor_plan = plan, .geofence_m = {}}))["floor_plan"] ==
        nlohmann::json{{"url", "/floor-plan"}, {"area_m", {0.0, -1.0, 20.0, 10.5}}});

  const auto file = folder.path() / "hall.png";
  const double infinite = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& area :
       {std::vector<double>{}, {0, 0, 1}, {0, 0, 0, 1}, {1, 0, 0, 1}, {0, 0, 1, -1}, {0, 0, infinite, 1}}) {
    CHECK_THROWS_WITH(read_floor_plan(file, area), Contains("--floor-plan-area") && Contains("X0 Y0 X1 Y1"));
  }
  const std::vector<double> area{0, 0, 1, 1};
  CHECK_THROWS_WITH(read_floor_plan(folder.path() / "none.png", area),
                    Contains("none.png") && Contains("does not exist"));
  CHECK_THROWS_WITH(read_floor_plan(write(folder, "hall.gif", "GIF"), area),
                    Contains("hall.gif") && Contains(".png"));
  CHECK_THROWS_WITH(read_floor_plan(write(folder, "empty.svg", ""), area),
                    Contains("empty.svg") && Contains("0 bytes"));
}

SCENARIO("a geofence has at least three corners") {
  const test::TemporaryFolder folder;
  const auto corners = read_geofence(write(folder, "area.csv", "# x_m,y_m\n0,0\n10,0\n10,5.5\n"));
  REQUIRE(corners.size() == 3);
  CHECK(corners[2] == std::array{10.0, 5.5});
  CHECK(nlohmann::json::parse(json_of({.floor_plan = {}, .geofence_m = corners}))["geofence"][2] ==
        nlohmann::json{10.0, 5.5});
  CHECK_THROWS_WITH(read_geofence(write(folder, "two.csv", "# x_m,y_m\n0,0\n1,1\n")),
                    Contains("two.csv") && Contains("2 corners"));
  CHECK_THROWS_WITH(read_geofence(write(folder, "bad.csv", "# x_m,y_m\n0,0\n1,east\n1,1\n")),
                    Contains("bad.csv") && Contains("3") && Contains("east"));
  CHECK_THROWS_AS(read_geofence(folder.path() / "none.csv"), files::IoError);
}

}  // namespace map_layers_test
