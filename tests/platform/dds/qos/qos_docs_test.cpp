/// The tables of docs/qos.md match qos/sonopose.xml.

#include "dds/dds_fixture.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/dds/qos/match.hpp>

#include <catch2/catch.hpp>

#include <chrono>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

namespace sonopose::dds::test::qos_docs_test {

using namespace std::chrono_literals;

const std::string library = "sonopose::";

bool is_native(const std::string& profile) {
  return profile.starts_with(library);
}

/// Topics of each profile as the docs list them: "`reset`, `pose`".
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

/// Reliability without the blocking time, which applies only to writers.
std::string reliability(const Qos& qos) {
  return qos.policy<policy::Reliability>().value().kind() == policy::ReliabilityKind::RELIABLE
             ? "reliable"
             : "best effort";
}

std::string history(const Qos& qos) {
  const auto value = qos.policy<policy::History>().value();
  if (value.kind() != policy::HistoryKind::KEEP_ALL) return "last " + std::to_string(value.depth());
  const auto limit = qos.policy<policy::ResourceLimits>().value().max_samples();
  return limit == core::LENGTH_UNLIMITED ? "all" : "all, up to " + std::to_string(limit);
}

std::string deadline(const Qos& qos) {
  return qos::text_of(ext::to_chrono(qos.policy<policy::Deadline>().value().period()));
}

std::string durability(const Qos& qos) {
  return qos.policy<policy::Durability>().value().kind() == policy::DurabilityKind::VOLATILE
             ? "volatile"
             : "transient local";
}

/// One property as a writer offers it and, where that differs, as a reader requests it.
std::string both(const qos::Provider& qos, const std::string& profile, std::string (*text)(const Qos&)) {
  const std::string offered = text(qos.datawriter_qos(profile));
  const std::string requested = text(qos.datareader_qos(profile));
  return offered + (offered == requested ? "" : "; reader: " + requested);
}

std::string blocking(const qos::Provider& qos, const std::string& profile) {
  return qos::text_of(
      ext::to_chrono(qos.datawriter_qos(profile).policy<policy::Reliability>().value().max_blocking_time()));
}

/// Cells of a profile that follow its name and topics.
std::string cells_of(const qos::Provider& qos, const std::string& profile) {
  const std::string most = " | " + both(qos, profile, history) + " | ";
  const std::string last = both(qos, profile, durability) + " |";
  if (!is_native(profile)) return both(qos, profile, reliability) + most + last;
  return blocking(qos, profile) + most + both(qos, profile, deadline) + " | " + last;
}

/// Names and topics of profiles that share a row: lists that are separated by commas.
struct SharedRow {
  std::string profiles;
  std::string topics;
};

void add_to(std::string& list, const std::string& more) {
  list += (list.empty() ? "" : ", ") + more;
}

/// Rows of the page's two tables of profiles.
std::set<std::string> rows_of_page() {
  std::ifstream page(std::string(SONOPOSE_SOURCE_DIR) + "/docs/qos.md");
  REQUIRE(page.good());
  std::set<std::string> rows;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| `")) rows.insert(line);
  }
  return rows;
}

TEST_CASE("The tables of docs/qos.md are what qos/sonopose.xml says, profile by profile") {
  const qos::Provider qos = project_qos();
  const auto topics = topics_by_profile();
  std::size_t native = 0;
  std::map<std::pair<bool, std::string>, SharedRow> shared_rows;  // native or not, and cells
  for (const std::string& profile : qos.profiles()) {
    SharedRow& row = shared_rows[{is_native(profile), cells_of(qos, profile)}];
    if (!is_native(profile)) {
      add_to(row.profiles, "`" + profile + "`");
      continue;
    }
    ++native;
    REQUIRE(topics.contains(profile));  // fails for a profile that no topic uses
    add_to(row.profiles, "`" + profile.substr(library.size()) + "`");
    add_to(row.topics, topics.at(profile));
  }
  std::set<std::string> rows;
  for (const auto& [key, row] : shared_rows) {
    rows.insert("| " + row.profiles + " | " + (key.first ? row.topics + " | " : "") + key.second);
  }
  CHECK(native == topics.size());
  CHECK(rows_of_page() == rows);
}

TEST_CASE("The example of docs/qos.md does what it says, to the profile that it names and to no other") {
  const std::string text = sonopose::test::read_text(SONOPOSE_SOURCE_DIR "/docs/qos.md");
  const std::string fence = "```xml\n";
  const std::size_t begin = text.find(fence) + fence.size();
  const std::size_t end = text.find("```", begin);
  REQUIRE(end != std::string::npos);
  qos::Provider qos = project_qos();
  const std::string heading = deadline(qos.datareader_qos("sonopose::Heading"));
  qos.merge(text.substr(begin, end - begin), "docs/qos.md");
  CHECK(deadline(qos.datareader_qos("sonopose::Fix")) == "10 s");
  CHECK(deadline(qos.datareader_qos("sonopose::Heading")) == heading);
}

TEST_CASE("Every profile sets every policy, and the general statements of docs/qos.md apply to all") {
  const qos::Provider qos = project_qos();
  for (const std::string& profile : qos.profiles()) {
    CAPTURE(profile);
    const Qos& writer = qos.datawriter_qos(profile);
    CHECK(writer.policy<policy::Reliability>().value().kind() == policy::ReliabilityKind::RELIABLE);
    for (const Qos* const end : {&writer, &qos.datareader_qos(profile)}) {
      CHECK(end->policy<policy::LatencyBudget>().value().duration() == core::Duration::zero());
      const auto limits = end->policy<policy::ResourceLimits>().value();
      CHECK(limits.max_instances() == core::LENGTH_UNLIMITED);
      if (profile != "ros2::Input" || end == &writer) {
        CHECK(limits.max_samples() == core::LENGTH_UNLIMITED);
        CHECK(limits.max_samples_per_instance() == core::LENGTH_UNLIMITED);
      }
      const policy::Liveliness liveliness = end->policy<policy::Liveliness>().value();
      const bool asserts = profile == "sonopose::Pose" && end == &writer;
      CHECK(liveliness.kind() ==
            (asserts ? policy::LivelinessKind::MANUAL_BY_TOPIC : policy::LivelinessKind::AUTOMATIC));
      const bool without_lease = !is_native(profile) || profile == "sonopose::Log";
      const auto lease = asserts         ? core::Duration::from_millisecs(100)
                         : without_lease ? core::Duration::infinite()
                                         : core::Duration(1);
      CHECK(liveliness.lease_duration() == lease);
      const bool is_pose = profile == "sonopose::Pose" || profile == "sonopose::LosslessPose";
      CHECK(end->policy<policy::Ownership>().value().kind() ==
            (is_pose ? policy::OwnershipKind::EXCLUSIVE : policy::OwnershipKind::SHARED));
      if (is_native(profile)) {
        CHECK(end->policy<policy::Reliability>().value().kind() == policy::ReliabilityKind::RELIABLE);
      } else {
        CHECK(end->policy<policy::Deadline>().value().period() == core::Duration::infinite());
      }
      if (is_pose && end == &writer) {
        CHECK(end->policy<policy::OwnershipStrength>().value().value() == 100);
      }
    }
    if (!is_native(profile)) CHECK(blocking(qos, profile) == "2 ms");
    const bool expires =
        std::set<std::string>{"sonopose::Imu",  "sonopose::Fix",    "sonopose::Heading", "sonopose::Twist",
                              "sonopose::Pose", "sonopose::Report", "sonopose::Truth",   "ros2::Rosout"}
            .contains(profile);
    const auto lifespan = expires ? core::Duration(10) : core::Duration::infinite();
    CHECK(writer.policy<policy::Lifespan>().value().duration() == lifespan);
  }
}

}  // namespace sonopose::dds::test::qos_docs_test
