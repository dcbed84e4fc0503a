#include "web/map_layers.hpp"

#include "csv/reader.hpp"
#include "files/error.hpp"
#include "files/random_access_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace sonopose::web {
namespace {

/// Type by the name's extension; empty for others.
std::string picture_type(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".png") return "image/png";
  if (ending == ".jpg" || ending == ".jpeg") return "image/jpeg";
  return ending == ".svg" ? "image/svg+xml" : "";
}

}  // namespace

http::Response read_picture(const std::filesystem::path& file) {
  constexpr std::uint64_t max_bytes = 32'000'000;
  const std::string type = picture_type(file);
  if (type.empty()) throw files::IoError(file.string() + ": a floor plan is a .png, .jpg or .svg file");
  const files::RandomAccessFile picture(file);
  if (picture.size() == 0 || picture.size() > max_bytes) {
    throw files::IoError(
        fmt::format("{}: {} bytes; a floor plan has 1 to {}", file.string(), picture.size(), max_bytes));
  }
  auto bytes = std::make_shared<std::string>(picture.size(), '\0');
  picture.read(0, std::as_writable_bytes(std::span(*bytes)));
  return {.content_type = type, .body = std::move(bytes)};
}

FloorPlan read_floor_plan(const std::filesystem::path& file, const std::vector<double>& area_m) {
  if (area_m.size() != 4 || !(area_m[0] < area_m[2]) || !(area_m[1] < area_m[3]) ||
      !std::isfinite(area_m[2] - area_m[0] + area_m[3] - area_m[1])) {
    throw std::invalid_argument(
        "--floor-plan-area: needs X0 Y0 X1 Y1 in metres, the lower left and the upper right corner of the "
        "picture, with X0 < X1 and Y0 < Y1");
  }
  return {.picture = read_picture(file), .area_m = {area_m[0], area_m[1], area_m[2], area_m[3]}};
}

std::vector<std::array<double, 2>> read_geofence(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 2> columns{"x [m]", "y [m]"};
  constexpr std::size_t max_corners = 10'000;
  csv::Reader reader(file, {.columns = columns, .required_columns = columns.size()});
  std::vector<std::array<double, 2>> corners_m;
  while (reader.next_row()) {
    corners_m.push_back({reader.number(0), reader.number(1)});
    if (corners_m.size() > max_corners) reader.fail(0, "more than 10000 corners");
  }
  if (corners_m.size() < 3) {
    throw files::IoError(
        fmt::format("{}: {} corners; a geofence has at least 3", file.string(), corners_m.size()));
  }
  return corners_m;
}

std::string json_of(const MapLayers& layers) {
  nlohmann::json json{{"floor_plan", nullptr}, {"geofence", nullptr}};
  if (layers.floor_plan) {
    json["floor_plan"] = {{"url", "/floor-plan"}, {"area_m", layers.floor_plan->area_m}};
  }
  if (!layers.geofence_m.empty()) json["geofence"] = layers.geofence_m;
  return json.dump();
}

}  // namespace sonopose::web
