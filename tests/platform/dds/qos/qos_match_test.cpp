#include "dds/dds_fixture.hpp"
#include <sonopose/dds/qos/match.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace sonopose::dds::test::qos_match_test {

using std::chrono::milliseconds;

std::vector<std::string> policies_of(const std::vector<qos::Mismatch>& mismatches) {
  std::vector<std::string> names;
  for (const qos::Mismatch& mismatch : mismatches) names.push_back(mismatch.policy);
  return names;
}

Qos reliable() {
  return Qos() << policy::Reliability::Reliable();
}

Qos in_partitions(const std::vector<std::string>& names) {
  return Qos() << policy::Partition(names);
}

Qos ordered_by(dds_destination_order_kind_t kind) {
  Qos qos;
  dds_qset_destination_order(qos.get(), kind);
  return qos;
}

Qos presented(dds_presentation_access_scope_kind_t scope, bool coherent, bool ordered) {
  Qos qos;
  dds_qset_presentation(qos.get(), scope, coherent, ordered);
  return qos;
}

Qos living(policy::LivelinessKind::Type kind, std::chrono::nanoseconds lease) {
  return Qos() << policy::Liveliness(kind, ext::to_duration(lease));
}

struct Case {
  const char* what;
  Qos writer;
  Qos reader;
  std::vector<std::string> mismatches;  // according to DDS 1.4, 2.2.3
};

std::vector<Case> cases() {
  using policy::LivelinessKind;
  const Qos local = Qos() << policy::Durability::TransientLocal();
  const Qos exclusive = Qos() << policy::Ownership::Exclusive();
  const auto deadline = [](int ms) { return Qos() << policy::Deadline(ext::to_duration(milliseconds(ms))); };
  const auto budget = [](int ms) {
    return Qos() << policy::LatencyBudget(ext::to_duration(milliseconds(ms)));
  };
  const milliseconds lease(100);
  return {
      {"defaults", {}, {}, {}},
      {"a reliable reader of a default writer", {}, reliable(), {}},
      {"a best-effort writer", Qos() << policy::Reliability::BestEffort(), reliable(), {"reliability"}},
      {"a best-effort writer and a default reader", Qos() << policy::Reliability::BestEffort(), {}, {}},
      {"a late reader's wish", {}, local, {"durability"}},
      {"more durability than asked for", local, {}, {}},
      {"the same deadline", deadline(100), deadline(100), {}},
      {"a shorter deadline than offered", deadline(200), deadline(100), {"deadline"}},
      {"a longer deadline than offered", deadline(100), deadline(200), {}},
      {"a deadline of a writer without one", {}, deadline(100), {"deadline"}},
      {"a deadline of the writer alone", deadline(100), {}, {}},
      {"a shorter latency budget", budget(5), budget(2), {"latency budget"}},
      {"a longer latency budget", budget(2), budget(5), {}},
      {"exclusive written, shared read", exclusive, {}, {"ownership"}},
      {"shared written, exclusive read", {}, exclusive, {"ownership"}},
      {"exclusive on both sides", exclusive, exclusive, {}},
      {"manual asked of automatic",
       living(LivelinessKind::AUTOMATIC, lease),
       living(LivelinessKind::MANUAL_BY_TOPIC, lease),
       {"liveliness"}},
      {"automatic asked of manual",
       living(LivelinessKind::MANUAL_BY_TOPIC, lease),
       living(LivelinessKind::AUTOMATIC, lease),
       {}},
      {"a shorter lease",
       living(LivelinessKind::AUTOMATIC, lease),
       living(LivelinessKind::AUTOMATIC, lease / 2),
       {"liveliness lease"}},
      {"a longer lease",
       living(LivelinessKind::AUTOMATIC, lease),
       living(LivelinessKind::AUTOMATIC, 2 * lease),
       {}},
      {"source order asked of reception order",
       {},
       ordered_by(DDS_DESTINATIONORDER_BY_SOURCE_TIMESTAMP),
       {"destination order"}},
      {"reception order asked of source order", ordered_by(DDS_DESTINATIONORDER_BY_SOURCE_TIMESTAMP), {}, {}},
      {"a wider scope", {}, presented(DDS_PRESENTATION_TOPIC, false, false), {"presentation scope"}},
      {"one partition alone", in_partitions({"a"}), {}, {"partition"}},
      {"two partitions", in_partitions({"a"}), in_partitions({"b"}), {"partition"}},
      {"one partition of two", in_partitions({"a", "b"}), in_partitions({"b", "c"}), {}},
      {"a pattern", in_partitions({"robot/arm"}), in_partitions({"robot/*"}), {}},
      {"a pattern of another name", in_partitions({"robot/arm"}), in_partitions({"r?bot"}), {"partition"}},
      {"two patterns", in_partitions({"a*"}), in_partitions({"a*"}), {"partition"}},
      {"everything for the default partition", {}, in_partitions({"*"}), {}},
      {"two at once",
       deadline(200),
       deadline(100) << policy::Ownership::Exclusive(),
       {"deadline", "ownership"}},
  };
}

TEST_CASE("Writer and reader match by the rules, and real ones match in the same cases") {
  const domain::DomainParticipant member = participant();
  int number = 0;
  for (const Case& c : cases()) {
    CAPTURE(c.what);
    const auto mismatches = qos::mismatches(c.writer, c.reader);
    CHECK(policies_of(mismatches) == c.mismatches);

    const topic::Topic<sonopose_ResetCommand> topic(member, "test/match_" + std::to_string(++number),
                                                    Qos());  // sets nothing that endpoints would take over
    // In C, which gives an endpoint a publisher or subscriber with the partition and presentation of its QoS.
    const dds_entity_t writer =
        dds_create_writer(ext::handle(member), ext::handle(topic), c.writer.get(), nullptr);
    const dds_entity_t reader =
        dds_create_reader(ext::handle(member), ext::handle(topic), c.reader.get(), nullptr);
    // Endpoints of one participant match on creation.
    dds_subscription_matched_status_t matched;
    REQUIRE(dds_get_subscription_matched_status(reader, &matched) == DDS_RETCODE_OK);
    CHECK(matched.current_count == (c.mismatches.empty() ? 1 : 0));
    // The defaults filled in by Cyclone DDS change nothing.
    Qos offered;
    Qos requested;
    REQUIRE(dds_get_qos(writer, offered.get()) == DDS_RETCODE_OK);
    REQUIRE(dds_get_qos(reader, requested.get()) == DDS_RETCODE_OK);
    CHECK(policies_of(qos::mismatches(offered, requested)) == c.mismatches);
    dds_requested_incompatible_qos_status_t refused;
    REQUIRE(dds_get_requested_incompatible_qos_status(reader, &refused) == DDS_RETCODE_OK);
    if (refused.total_count > 0) {
      CHECK(std::any_of(mismatches.begin(), mismatches.end(),
                        [&](const auto& mismatch) { return mismatch.policy_id == refused.last_policy_id; }));
    }
    dds_delete(reader);
    dds_delete(writer);
  }
}

TEST_CASE("A mismatch contains the offered value, the requested value and the rule") {
  const auto only = [](const Qos& writer, const Qos& reader) {
    const auto mismatches = qos::mismatches(writer, reader);
    REQUIRE(mismatches.size() == 1);
    return qos::text_of(mismatches.front());
  };
  CHECK(only(Qos() << policy::Deadline(ext::to_duration(milliseconds(200))),
             Qos() << policy::Deadline(ext::to_duration(milliseconds(100)))) ==
        "deadline: offered 200 ms, requested 100 ms: a reader must not request less than is offered");
  CHECK(only(Qos() << policy::Ownership::Exclusive(), {}) ==
        "ownership: offered exclusive, requested shared: both endpoints must have the same value");
  CHECK(only({}, Qos() << policy::Deadline(ext::to_duration(milliseconds(1500)))) ==
        "deadline: offered infinite, requested 1.5 s: a reader must not request less than is offered");
  CHECK(only(in_partitions({"a", "b"}), {}) ==
        "partition: offered 'a', 'b', requested '': the endpoints must share one");
}

TEST_CASE("A reader must take the representation that a writer sends") {
  const auto representation = [](std::vector<dds_data_representation_id_t> values) {
    Qos qos;
    dds_qset_data_representation(qos.get(), static_cast<std::uint32_t>(values.size()), values.data());
    return qos;
  };
  const Qos xcdr1 = representation({DDS_DATA_REPRESENTATION_XCDR1});
  const Qos xcdr2 = representation({DDS_DATA_REPRESENTATION_XCDR2});
  const Qos both = representation({DDS_DATA_REPRESENTATION_XCDR1, DDS_DATA_REPRESENTATION_XCDR2});
  CHECK(policies_of(qos::mismatches(xcdr1, xcdr2)) == std::vector<std::string>{"data representation"});
  CHECK(qos::mismatches(xcdr2, both).empty());
  CHECK(qos::mismatches(xcdr1, {}).empty());
}

TEST_CASE("Durations as text") {
  CHECK(qos::text_of(ext::infinite) == "infinite");
  CHECK(qos::text_of(std::chrono::nanoseconds(0)) == "0");
  CHECK(qos::text_of(std::chrono::nanoseconds(7)) == "7 ns");
  CHECK(qos::text_of(milliseconds(2)) == "2 ms");
  CHECK(qos::text_of(milliseconds(100)) == "100 ms");
  CHECK(qos::text_of(milliseconds(3000)) == "3 s");
  CHECK(qos::text_of(milliseconds(1250)) == "1.25 s");
}

TEST_CASE("In the project's QoS file every profile matches itself, and live matches lossless") {
  const qos::Provider qos = project_qos();
  const std::vector<std::string> live{
      "Imu",   "Fix",     "Heading",         "Pose",          "Report",  "Status",
      "Truth", "Command", "SettingsRequest", "SettingsReply", "Settings"};
  const std::vector<std::string> with_lossless{"Imu", "Fix", "Heading", "Pose", "Report"};
  const auto check = [&](const std::string& written, const std::string& read) {
    CAPTURE(written, read);
    for (const auto& mismatch : qos::mismatches(qos.datawriter_qos("sonopose::" + written),
                                                qos.datareader_qos("sonopose::" + read))) {
      FAIL_CHECK(qos::text_of(mismatch));
    }
  };
  for (const std::string& name : live) check(name, name);
  for (const std::string& name : with_lossless) {
    check("Lossless" + name, "Lossless" + name);
    check("Lossless" + name, name);
    check(name, "Lossless" + name);
  }
}

}  // namespace sonopose::dds::test::qos_match_test
