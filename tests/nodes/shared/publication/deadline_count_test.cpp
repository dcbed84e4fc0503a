#include "publication/deadline_count.hpp"

#include <catch2/catch.hpp>

namespace deadline_count_test {

using namespace sonopose;
using namespace sonopose::publication;

constexpr TimeNs ms = 1'000'000;

SCENARIO("whole periods without a sample are counted") {
  DeadlineCount count(100 * ms);
  CHECK(count.count(SteadyTime{5'000 * ms}) == 0);  // no sample yet
  count.on_sample(SteadyTime{1'000 * ms});
  count.on_sample(SteadyTime{1'090 * ms});
  CHECK(count.count(SteadyTime{1'189 * ms}) == 0);
  CHECK(count.count(SteadyTime{1'190 * ms}) == 1);
  CHECK(count.count(SteadyTime{1'340 * ms}) == 2);
  count.on_sample(SteadyTime{1'340 * ms});
  CHECK(count.count(SteadyTime{1'350 * ms}) == 2);
  CHECK(count.count(SteadyTime{1'440 * ms}) == 3);
}

}  // namespace deadline_count_test
