#include "observation/status_counters.hpp"

#include "dds/topics/field_lists.hpp"

#include <catch2/catch.hpp>

#include <set>
#include <string_view>
#include <tuple>

namespace sonopose::status_counters_test {

using namespace sonopose::observation;

template <class Pair>
constexpr bool is_counter = false;
template <class Native, class Idl, class IdlField>
constexpr bool is_counter<dds::topics::fields::Plain<Native, Idl, std::uint64_t, IdlField>> = true;

/// Number of 64-bit counters in a type.
template <class Native>
constexpr std::size_t numbers_sent() {
  return std::apply(
      [](const auto&... pair) { return (std::size_t{is_counter<std::decay_t<decltype(pair)>>} + ...); },
      dds::topics::fields::Pairs<Native>::list);
}

template <class Counters>
std::size_t distinct_names(const Counters& counters) {
  std::set<std::string_view> names;
  for (const auto& counter : counters) names.insert(counter.name);
  return names.size();
}

SCENARIO("consumers show every counter of the statuses") {
  GIVEN("the fields that the statuses send") {
    THEN("each 64-bit number but the fusion's identity is a counter with a name of its own") {
      CHECK(distinct_names(bridge_counters) == numbers_sent<BeaconStatus>());
      CHECK(distinct_names(fusion_counters) == numbers_sent<FusionStatus>() - 1);
    }
  }
}

}  // namespace sonopose::status_counters_test
