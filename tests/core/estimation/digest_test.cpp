#include "estimation/digest.hpp"

#include <catch2/catch.hpp>

namespace digest_test {

using namespace sonopose;
using estimation::Digest;

std::uint64_t digest_of(const FusedPose& pose) {
  Digest digest;
  digest.add(pose);
  return digest.value();
}

std::uint64_t digest_of(const estimation::documented::State& state) {
  Digest digest;
  digest.add(estimation::AnySnapshot(estimation::documented::Snapshot{.state = state, .counters = {}}));
  return digest.value();
}

TEST_CASE("the smallest change of a pose changes its digest; its transport times do not") {
  FusedPose pose;
  pose.position_world_m = {1, 2, 3};
  FusedPose other = pose;
  CHECK(digest_of(pose) == digest_of(other));
  other.position_world_m.z() = std::nextafter(3.0, 4.0);
  CHECK(digest_of(pose) != digest_of(other));
  other = pose;
  other.status = 1;
  CHECK(digest_of(pose) != digest_of(other));
  other = pose;
  other.fusion_out_time_ns = 5;
  CHECK(digest_of(pose) == digest_of(other));
}

TEST_CASE("a change in any group of the state changes its digest") {
  const estimation::documented::State plain;
  CHECK(digest_of(plain) == digest_of(estimation::documented::State{}));
  estimation::documented::State state = plain;
  state.trust.rebuilt = 1;
  CHECK(digest_of(state) != digest_of(plain));
  state = plain;
  state.body.history.push({1, Vector3d::Zero(), 0.0});
  CHECK(digest_of(state) != digest_of(plain));
  state = plain;
  state.filter.turn_in_world({0.0, 0.0, 1e-9});
  CHECK(digest_of(state) != digest_of(plain));
  state = plain;
  state.outage.init_phase = estimation::documented::InitPhase::tracking;
  CHECK(digest_of(state) != digest_of(plain));
}

TEST_CASE("the order of the values counts, and the text has 16 digits") {
  Digest one;
  one.add(1.0);
  one.add(2.0);
  Digest two;
  two.add(2.0);
  two.add(1.0);
  CHECK(one.value() != two.value());
  CHECK(one.text().size() == 16);
}

}  // namespace digest_test
