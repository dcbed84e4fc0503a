/// The table of docs/qos.md is what qos/sonopose.xml says.

#include "dds_fixture.hpp"
#include <sonopose/dds/qos_match.hpp>

#include <catch2/catch.hpp>

#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace sonopose::dds::test {
namespace {

const std::string library = "sonopose::";

/// Profile → its topics, as the docs list them: "`reset`, `pose`".
std::map<std::string, std::string> topics_by_profile() {
  std::map<std::string, std::string> result;
  const auto note = [&](const char* profile, const char* topic) {
    std::string& list = result[profile];
    list += (list.empty() ? "`" : ", `") + std::string(topic).substr(std::string("sonopose/").size()) + "`";
  };
  const auto note_both = [&](const auto& entry) {
    note(entry.profile, entry.name);
    if (std::string(entry.profile) != entry.lossless_profile) note(entry.lossless_profile, entry.name);
  };
  std::apply([&](const auto&... entry) { (note_both(entry), ...); }, topics::all);
  return result;
}

std::string history(const Qos& qos) {
  const auto value = qos.policy<policy::History>().value();
  return value.kind == policy::HistoryKind::keep_all ? "all" : "last " + std::to_string(value.depth);
}

std::string deadline(const Qos& qos) {
  return text_of(qos.policy<policy::Deadline>().value().period);
}

std::string liveliness(const Qos& qos) {
  const auto value = qos.policy<policy::Liveliness>().value();
  const std::map<policy::LivelinessKind, std::string> names{
      {policy::LivelinessKind::automatic, "automatic"},
      {policy::LivelinessKind::manual_by_participant, "manual by participant"},
      {policy::LivelinessKind::manual_by_topic, "manual by topic"}};
  return names.at(value.kind) + ", " + text_of(value.lease_duration);
}

std::string ownership(const Qos& qos) {
  return qos.policy<policy::Ownership>().value().kind == policy::OwnershipKind::exclusive ? "exclusive"
                                                                                          : "shared";
}

std::string durability(const Qos& qos) {
  return qos.policy<policy::Durability>().value().kind == policy::DurabilityKind::volatile_data
             ? "volatile"
             : "transient local";
}

std::string row_of(const QosProvider& qos, const std::string& profile, const std::string& topics) {
  const Qos& writer = qos.datawriter_qos(profile);
  const Qos& reader = qos.datareader_qos(profile);
  const auto both = [&](std::string (*text)(const Qos&)) {
    const std::string offered = text(writer);
    const std::string requested = text(reader);
    return offered == requested ? offered : offered + "; reader: " + requested;
  };
  const auto reliability = writer.policy<policy::Reliability>().value();
  std::string owner = both(ownership);
  if (owner == "exclusive") {
    owner += ", " + std::to_string(writer.policy<policy::OwnershipStrength>().value().value);
  }
  std::string row = "| `" + profile.substr(library.size()) + "` | " + topics + " |";
  row += " reliable, " + text_of(reliability.max_blocking_time) + " |";
  for (const std::string& cell : {both(history), both(deadline), both(liveliness), owner, both(durability),
                                  std::to_string(writer.policy<policy::TransportPriority>().value().value)}) {
    row += " " + cell + " |";
  }
  return row;
}

/// The rows of the page's first table.
std::set<std::string> rows_of_page() {
  std::ifstream page(std::string(SONOPOSE_SOURCE_DIR) + "/docs/qos.md");
  REQUIRE(page.good());
  std::set<std::string> rows;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| `")) rows.insert(line);
  }
  return rows;
}

TEST_CASE("The table of docs/qos.md is what qos/sonopose.xml says, profile by profile") {
  const QosProvider qos = project_qos();
  const auto topics = topics_by_profile();
  std::set<std::string> profiles;
  std::set<std::string> rows;
  for (const std::string& profile : qos.profiles()) {
    profiles.insert(profile);
    REQUIRE(topics.contains(profile));  // a profile that no topic uses is left over
    rows.insert(row_of(qos, profile, topics.at(profile)));
  }
  CHECK(profiles.size() == topics.size());
  CHECK(rows_of_page() == rows);
}

TEST_CASE("The example of docs/qos.md does what it says, to the profile that it names and to no other") {
  std::ifstream page(std::string(SONOPOSE_SOURCE_DIR) + "/docs/qos.md");
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  const std::string fence = "```xml\n";
  const std::size_t begin = text.find(fence) + fence.size();
  const std::size_t end = text.find("```", begin);
  REQUIRE(end != std::string::npos);
  QosProvider qos = project_qos();
  const std::string heading = deadline(qos.datareader_qos("sonopose::Heading"));
  qos.lay_over(text.substr(begin, end - begin), "docs/qos.md");
  CHECK(deadline(qos.datareader_qos("sonopose::Fix")) == "10 s");
  CHECK(deadline(qos.datareader_qos("sonopose::Heading")) == heading);
}

TEST_CASE("Every profile states every policy, and what docs/qos.md says of all holds for all") {
  const QosProvider qos = project_qos();
  for (const std::string& profile : qos.profiles()) {
    CAPTURE(profile);
    const Qos& writer = qos.datawriter_qos(profile);
    for (const Qos* const end : {&writer, &qos.datareader_qos(profile)}) {
      CHECK(end->policy<policy::Reliability>().value().kind == policy::ReliabilityKind::reliable);
      CHECK(end->policy<policy::LatencyBudget>().value().duration == Duration::zero());
      CHECK(end->policy<policy::Liveliness>().value().lease_duration != infinite);
      const auto limits = end->policy<policy::ResourceLimits>().value();
      CHECK(limits.max_samples == policy::length_unlimited);
      CHECK(limits.max_instances == policy::length_unlimited);
      CHECK(limits.max_samples_per_instance == policy::length_unlimited);
    }
    CHECK(writer.policy<policy::Lifespan>().value().duration == infinite);
  }
}

}  // namespace
}  // namespace sonopose::dds::test
