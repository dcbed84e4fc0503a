#pragma once
/// \file
/// Layers of the map under the tracks: a floor plan and a geofence.

#include "web/http/server.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

namespace sonopose::web {

/// A picture and its place.
struct FloorPlan {
  http::Response picture;
  std::array<double, 4> area_m{};  ///< x and y of its lower left corner, then of its upper right one; world
};

struct MapLayers {
  std::optional<FloorPlan> floor_plan;
  std::vector<std::array<double, 2>> geofence_m;  ///< corners of a polygon, x and y in world; empty: none
};

/// Reads a picture: PNG, JPEG or SVG, at most 32 MB. Throws files::IoError that names the file.
http::Response read_picture(const std::filesystem::path& file);

/// Reads a picture and places it. Throws also std::invalid_argument for an area without size.
FloorPlan read_floor_plan(const std::filesystem::path& file, const std::vector<double>& area_m);

/// Reads the corners, at least three, from a CSV file with the columns x_m and y_m. Throws files::IoError
/// that names file and line.
std::vector<std::array<double, 2>> read_geofence(const std::filesystem::path& file);

/// {"floor_plan": null | {"url", "area_m"}, "geofence": null | [[x, y], ...]}.
std::string json_of(const MapLayers& layers);

}  // namespace sonopose::web
