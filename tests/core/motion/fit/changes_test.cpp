#include "motion/fit/changes.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <optional>
#include <utility>
#include <vector>

namespace fit_changes_test {

using namespace sonopose::motion::fit;

Measured angle(double angle_deg) {
  constexpr double std_deg = 2.0;
  return {angle_deg * sonopose::geometry::radians_per_degree,
          std_deg * sonopose::geometry::radians_per_degree};
}

/// Three straight ways. Without a mirror their mounts differ by up to 49°, with one by up to 8°.
std::vector<Piece> straight_ways() {
  std::vector<Piece> pieces;
  for (const auto& [mount_deg, mirrored_deg] : {std::pair(-3.0, 171.0), {49.0, 172.0}, {3.0, 179.0}}) {
    Piece piece;
    piece.fixes = 80;
    piece.length_s = 8;
    piece.span_m = 5;
    piece.residual_m = 0.02;
    piece.mount_rad = angle(mount_deg);
    piece.mirrored_fixes.residual_m = 0.02;
    piece.mirrored_fixes.mount_rad = angle(mirrored_deg);
    pieces.push_back(piece);
  }
  return pieces;
}

SCENARIO("On straight ways, mounts that agree only with a mirror show it, if it fits as well everywhere") {
  std::vector<Piece> pieces = straight_ways();
  CHECK(mirror_in(pieces, 0.0) == MapChange::invert_x);
  WHEN("it fits one way worse, as where the map turned instead") {
    pieces.front().mirrored_fixes.log_likelihood = -70;
    THEN("the map is not mirrored") {
      CHECK(mirror_in(pieces, 0.0) == std::nullopt);
    }
  }
}

}  // namespace fit_changes_test
