/// Enumeration of the engine's state fields.

#include <sonopose/estimation/documented/state_fields.hpp>

#include <catch2/catch.hpp>

#include <map>
#include <set>
#include <string>

namespace state_fields_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;

struct AnyField {
  template <class Field>
  operator Field() const;  // NOLINT(google-explicit-constructor): converts to any field
};

/// Counts the fields of an aggregate: the largest number of initialisers that it accepts.
template <class Group, class... Fields>
constexpr std::size_t field_count(Fields... fields) {
  if constexpr (requires { Group{fields..., AnyField{}}; }) {
    return field_count<Group>(fields..., AnyField{});
  } else {
    return sizeof...(Fields);
  }
}

TEST_CASE("every field of every group is listed once, under its own name") {
  State state;
  std::multiset<std::string> names;
  std::map<std::string, std::size_t> found;
  for_each_field(state, [&](const std::string& name, const auto&) {
    names.insert(name);
    const auto dot = name.find('.');
    ++found[dot == std::string::npos ? name : name.substr(0, dot)];
  });
  for (const std::string& name : names) CHECK(names.count(name) == 1);
  const std::map<std::string, std::size_t> expected{
      {"body", field_count<Kinematics>()},
      {"filter", 1},
      {"startup", field_count<StartupState>()},
      {"admission", field_count<estimation::aiding::AdmissionState>()},
      {"default_position", field_count<estimation::aiding::DefaultPosition>()},
      {"frozen", field_count<FrozenState>()},
      {"scatter", field_count<ScatterState>()},
      {"trust", field_count<TrustState>()},
      {"drift", field_count<DriftState>()},
      {"velocity", field_count<VelocityState>()},
      {"alignment", field_count<AlignmentState>()},
      {"heading", field_count<HeadingState>()},
      {"outage", field_count<OutageState>()},
      {"runaway", field_count<RunawayState>()},
      {"uncertainty", field_count<UncertaintyState>()},
      {"previous_rate_body_radps", 1},
      {"in_imu_gap", 1}};
  CHECK(found == expected);
  CHECK(field_count<State>() == expected.size());
}

}  // namespace state_fields_test
