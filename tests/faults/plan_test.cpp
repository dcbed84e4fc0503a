/// Plans are drawn from their seed alone, and the first ones contain every fault.

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
      CHECK((step.fault != Fault::unplug || plan.line == Line::serial));
      CHECK((step.fault != Fault::reorder || plan.line == Line::udp));
    }
  }
  CHECK(faults.size() == 9);
  CHECK(killed.size() == 4);
}

}  // namespace plan_test
