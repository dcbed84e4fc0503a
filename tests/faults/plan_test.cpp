/// Plans depend on their seed alone, and the first ones contain every fault.

#include "faults/plan.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <set>

namespace plan_test {

using namespace sonopose;
using namespace sonopose::faults;

SCENARIO("a plan can be repeated by its seed") {
  CHECK(draw_plan(3) == draw_plan(3));
  CHECK(text_of(draw_plan(3)) == text_of(draw_plan(3)));
  CHECK_FALSE(draw_plan(3).steps == draw_plan(4).steps);
  CHECK_FALSE(stepped_clock(draw_plan(3, false)));
}

SCENARIO("the first fifty plans have every fault, three to five each, and end within five seconds") {
  std::set<Fault> faults;
  std::set<Role> killed;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Plan plan = draw_plan(seed);
    CAPTURE(text_of(plan));
    CHECK(plan.steps.size() >= 3);
    CHECK(plan.steps.size() <= 5);
    std::map<std::pair<bool, Role>, TimeNs> free_ns;
    for (const Step& step : plan.steps) {
      faults.insert(step.fault);
      if (step.fault == Fault::kill) killed.insert(step.target);
      TimeNs& free = free_ns[{step.fault >= Fault::delay, step.target}];
      CHECK(step.at_ns >= free);
      free = step.at_ns + step.for_ns;
      CHECK(free < 5'000'000'000);
      if (step.fault == Fault::unplug) CHECK(plan.line == Line::serial);
      if (step.fault == Fault::reorder) CHECK(plan.line == Line::udp);
    }
  }
  CHECK(faults.size() == 9);
  CHECK(killed.size() == 4);
}

SCENARIO("the plans of the suite have almost every fault, and every line, disk and loss") {
  constexpr TimeNs long_ns = 650'000'000;   // longer than the checker allows for unmarked poses
  std::set<std::pair<Fault, bool>> faults;  // the flag is true if the bridge is the target
  std::set<Line> lines;
  std::set<Line> long_bridge_stops;
  std::set<Disk> disks;
  std::set<bool> losing_bridges;
  bool has_third_fusion = false;
  for (const std::uint64_t seed : short_seeds) {
    const Plan plan = draw_plan(seed);
    lines.insert(plan.line);
    disks.insert(plan.disk);
    if (plan.loss) losing_bridges.insert(plan.loss->role == Role::bridge);
    for (const Step& step : plan.steps) {
      const bool of_bridge = step.fault < Fault::few_descriptors && step.target == Role::bridge;
      faults.emplace(step.fault, of_bridge);
      if (step.fault == Fault::stop && of_bridge && step.for_ns > long_ns)
        long_bridge_stops.insert(plan.line);
      if (step.fault < Fault::few_descriptors && step.target == Role::third_fusion) has_third_fusion = true;
    }
  }
  CHECK(faults.size() == 2 * 4 + 5 - 2);
  CHECK_FALSE(faults.contains({Fault::unplug, false}));
  CHECK_FALSE(faults.contains({Fault::clock_step, true}));
  CHECK(lines.size() == 2);
  CHECK(long_bridge_stops.size() == 2);
  CHECK(disks.size() == 3);
  CHECK(losing_bridges.size() == 2);
  CHECK(has_third_fusion);
}

}  // namespace plan_test
