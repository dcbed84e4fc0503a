#include "observation/pose_writers.hpp"

#include <catch2/catch.hpp>

#include <limits>

namespace sonopose::pose_writers_test {

using namespace sonopose::observation;
using Catch::Contains;

dds::Qos strength(std::int32_t value) {
  return dds::Qos() << dds::policy::OwnershipStrength(value);
}

/// Pose writer of a fusion that serves the beacons `served`.
PoseWriter fusion(const std::string& name, std::int32_t its_strength, std::set<BeaconAddress> served) {
  return {.participant_key = name,
          .process = {name, "rover", 12, "udp/10.0.0.5:7410"},
          .qos = strength(its_strength),
          .has_status = true,
          .served = std::move(served)};
}

SCENARIO("the pose writers of fusions are no problem while one consumer can tell them apart") {
  GIVEN("two standby fusions, each with a second writer of strength 0") {
    const std::vector writers{fusion("a", 200, {7}), fusion("a", 0, {7}), fusion("b", 100, {7}),
                              fusion("b", 0, {7})};
    THEN("there is no problem") {
      CHECK(problems_of(writers).empty());
    }
  }
  GIVEN("two fusions of one strength that share the beacons out") {
    THEN("there is no problem") {
      CHECK(problems_of({fusion("a", 100, {7, 8}), fusion("b", 100, {9})}).empty());
    }
  }
  GIVEN("two fusions of one strength in different partitions") {
    PoseWriter a = fusion("a", 100, {7});
    PoseWriter b = fusion("b", 100, {7});
    a.qos << dds::policy::Partition("east");
    b.qos << dds::policy::Partition("west");
    THEN("there is no problem") {
      CHECK(problems_of({a, b}).empty());
    }
  }
}

SCENARIO("two fusions of one strength for one beacon are a problem") {
  const auto problems = problems_of({fusion("a", 100, {7, 8}), fusion("b", 100, {8})});
  REQUIRE(problems.size() == 1);
  CHECK_FALSE(problems.front().foreign);
  CHECK_THAT(problems.front().what,
             Contains("a (process 12 on rover) and b (process 12 on rover) write poses of beacon 8"));
}

SCENARIO("a pose writer without fusion statuses is a problem, whatever its strength") {
  const std::int32_t its_strength = GENERATE(0, 1, 1000);
  PoseWriter intruder = fusion("intruder", its_strength, {});
  intruder.has_status = false;
  const auto problems = problems_of({fusion("a", 100, {7}), intruder});
  REQUIRE(problems.size() == 1);
  CHECK(problems.front().foreign);
  CHECK_THAT(problems.front().what, Contains("intruder (process 12 on rover) writes poses with strength " +
                                             std::to_string(its_strength)));
}

/// Two processes with a writer of poses and one of statuses each, as discovery finds them.
struct TwoProcesses {
  static constexpr std::uint64_t own_poses = 1;
  static constexpr std::uint64_t own_statuses = 2;
  static constexpr std::uint64_t other_poses = 3;
  static constexpr std::uint64_t other_statuses = 4;

  ServedBeacons served;
  std::vector<dds::FoundParticipant> participants{{.key = "own",
                                                   .process_name = "sonopose-fusion",
                                                   .host_name = "rover",
                                                   .process_id = 12,
                                                   .addresses = {},
                                                   .user_data = {}},
                                                  {.key = "other",
                                                   .process_name = "sonopose-fusion",
                                                   .host_name = "rover",
                                                   .process_id = 13,
                                                   .addresses = {},
                                                   .user_data = {}}};
  std::vector<dds::FoundEndpoint> writers{endpoint(own_poses, "own", "sonopose/pose", 100),
                                          endpoint(own_statuses, "own", "sonopose/fusion_status", 0),
                                          endpoint(other_poses, "other", "sonopose/pose", 1000),
                                          endpoint(other_statuses, "other", "sonopose/fusion_status", 0)};

  static dds::FoundEndpoint endpoint(std::uint64_t handle, const std::string& participant,
                                     const std::string& topic, std::int32_t its_strength) {
    return {.key = {},
            .handle = dds::core::InstanceHandle(handle),
            .participant_key = participant,
            .topic_name = topic,
            .type_name = {},
            .qos = strength(its_strength)};
  }

  void pose(std::uint64_t writer, double at_s) {
    served.on_pose(7, dds::core::InstanceHandle(writer), SteadyTime{to_ns(at_s)});
  }

  void status(std::uint64_t writer, FusionRole role, double at_s = 1) {
    FusionStatus status;
    status.address = 7;
    status.role = role;
    served.on(status, dds::core::InstanceHandle(writer), SteadyTime{to_ns(at_s)});
  }

  std::vector<PoseWriterProblem> problems(double at_s) const {
    return problems_of(pose_writers_of(writers, participants, served, SteadyTime{to_ns(at_s)}));
  }
};

SCENARIO("a new owner of a beacon's poses must do what a fusion does") {
  GIVEN("a fusion that serves a beacon") {
    TwoProcesses two;
    two.pose(TwoProcesses::own_poses, 1);
    two.status(TwoProcesses::own_statuses, FusionRole::serving);
    REQUIRE(two.problems(10).empty());
    WHEN("a stronger process that only has a writer of statuses takes the beacon over") {
      two.pose(TwoProcesses::other_poses, 10);
      THEN("it is named") {
        const auto problems = two.problems(10.5);
        REQUIRE(problems.size() == 1);
        CHECK(problems.front().foreign);
        CHECK_THAT(problems.front().what,
                   Contains("sonopose-fusion (process 13 on rover) writes poses with strength 1000") &&
                       Contains("took beacon 7 over from sonopose-fusion (process 12 on rover)"));
        AND_WHEN("the other fusion has ended") {
          two.writers.erase(two.writers.begin(), two.writers.begin() + 2);
          THEN("it is named, because it sends no statuses") {
            CHECK(two.problems(12).empty());
            const auto later = two.problems(14);
            REQUIRE(later.size() == 1);
            CHECK_THAT(later.front().what, Contains("sends no status of beacon 7"));
          }
        }
      }
    }
    WHEN("it sends statuses that it serves the beacon afterwards") {
      two.pose(TwoProcesses::other_poses, 10);
      two.status(TwoProcesses::other_statuses, FusionRole::serving, 10.5);
      THEN("it is named as well") {
        CHECK(two.problems(20).size() == 1);
      }
    }
    WHEN("a standby warms up before it takes the beacon over") {
      two.status(TwoProcesses::other_statuses, FusionRole::warming);
      two.pose(TwoProcesses::other_poses, 15);
      two.status(TwoProcesses::other_statuses, FusionRole::serving);
      THEN("there is no problem") {
        CHECK(two.problems(20).empty());
      }
    }
    WHEN("a fusion that stood by takes it over, and the stronger one returns") {
      two.status(TwoProcesses::other_statuses, FusionRole::serving);
      two.pose(TwoProcesses::other_poses, 15);
      two.pose(TwoProcesses::own_poses, 16);
      two.pose(TwoProcesses::other_poses, 17);
      THEN("there is no problem") {
        CHECK(two.problems(20).empty());
      }
    }
    WHEN("the fusion ends, and another one starts") {
      two.writers.erase(two.writers.begin(), two.writers.begin() + 2);
      two.pose(TwoProcesses::other_poses, 10);
      two.status(TwoProcesses::other_statuses, FusionRole::sole, 11);
      THEN("there is no problem") {
        CHECK(two.problems(20).empty());
      }
    }
    WHEN("a process warms up with a strength that no fusion can have") {
      two.writers[2].qos = strength(std::numeric_limits<std::int32_t>::max());
      two.status(TwoProcesses::other_statuses, FusionRole::warming);
      THEN("it is named") {
        const auto problems = two.problems(11);
        REQUIRE(problems.size() == 1);
        CHECK_THAT(problems.front().what, Contains("whose strength is at most 1000000"));
      }
    }
  }
}

SCENARIO("a process that displaces a fusion outside of a standby pair is named, whatever statuses it sends") {
  TwoProcesses two;
  two.pose(TwoProcesses::own_poses, 1);
  two.status(TwoProcesses::own_statuses, FusionRole::sole);
  const FusionRole role = GENERATE(FusionRole::sole, FusionRole::serving);
  two.status(TwoProcesses::other_statuses, role, 2);
  two.pose(TwoProcesses::other_poses, 10);
  const auto problems = two.problems(20);
  REQUIRE(problems.size() == 1);
  CHECK_THAT(
      problems.front().what,
      Contains("poses of beacon 7 from sonopose-fusion (process 13 on rover) with strength 1000, not from "
               "sonopose-fusion (process 12 on rover)"));
}

SCENARIO("a writer serves the beacons of its latest poses and of its serving statuses") {
  TwoProcesses two;
  const auto served_by_own = [&] {
    return pose_writers_of(two.writers, two.participants, two.served, {}).front().served;
  };
  two.pose(TwoProcesses::own_poses, 0);
  CHECK(served_by_own() == std::set<BeaconAddress>{7});
  two.pose(TwoProcesses::other_poses, 0);  // consumers now receive the other writer
  CHECK(served_by_own().empty());
  two.status(TwoProcesses::own_statuses, FusionRole::serving);
  CHECK(served_by_own() == std::set<BeaconAddress>{7});
  two.status(TwoProcesses::own_statuses, FusionRole::stalled);
  CHECK(served_by_own().empty());
}

SCENARIO("the name of a process is no command for a terminal, and no line of its own") {
  CHECK(text_of({"x\x1b[2J\nforged", "rover\a", 12}) == "x\\x1b[2J\\x0aforged (process 12 on rover\\x07)");
}

}  // namespace sonopose::pose_writers_test
