/// Publication of a beacon that leaves and returns.

#include "publication/sensor_publisher.hpp"

#include "support/test_domain.hpp"
#include "support/wait_until.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

#include <functional>
#include <utility>
#include <vector>

namespace sonopose::bridge_node_test {

using publication::SampleSink;

/// A source that runs a test's script.
class ScriptedSource final : public publication::Source {
public:
  explicit ScriptedSource(std::function<void(SampleSink&)> script) : script_(std::move(script)) {}
  void run(SampleSink& sink, const process::StopSignal& /*stop*/) override { script_(sink); }

private:
  std::function<void(SampleSink&)> script_;
};

/// Event numbers received on a topic, and how often its instances ended.
struct Received {
  dds::sub::DataReader<sonopose_ImuSample> reader;
  std::vector<std::uint64_t> sequences;
  int ends = 0;

  template <class Done>
  bool wait_until(const Done& done) {
    return test::wait_until([&] {
      dds::ext::try_take_each(
          reader,
          [this](const sonopose_ImuSample& sample, const dds::sub::SampleInfo&) {
            sequences.push_back(dds::topics::from_idl(sample).sequence);
          },
          [this](const sonopose_ImuSample&, const dds::sub::SampleInfo& info) {
            if (!dds::ext::is_alive(info)) ++ends;
          });
      return done();
    });
  }
};

void send_three(SampleSink& sink) {
  ImuSample sample;
  sample.address = 7;
  for (int i = 0; i < 3; ++i) sink.on(sample);
}

SCENARIO("a beacon that is gone ends its streams, and its event numbers go on when it returns") {
  GIVEN("a bridge, and a reader in another participant") {
    const test::TestDomain domain;
    const auto participant = dds::ext::participant({.domain_id = domain.id()});
    Received received{.reader = dds::topics::make_reader(participant, dds::qos::Provider(), dds::topics::imu),
                      .sequences = {}};
    publication::SensorPublisher node({.domain_id = domain.id()}, {.qos_file = {}, .record_folder = {}});
    ScriptedSource source([&](SampleSink& sink) {
      REQUIRE(received.wait_until(
          [&] { return received.reader.subscription_matched_status().current_count() == 1; }));
      send_three(sink);
      REQUIRE(received.wait_until([&] { return received.sequences.size() == 3; }));
      CHECK(received.ends == 0);
      sink.on_gone(7);
      CHECK(received.wait_until([&] { return received.ends == 1; }));
      sink.on_gone(7);  // already ended
      send_three(sink);
      REQUIRE(received.wait_until([&] { return received.sequences.size() == 6; }));
    });
    WHEN("the beacon sends, is gone, and sends again") {
      node.run(source, process::StopSignal());
      THEN("the events are numbered without a gap") {
        CHECK(received.sequences == std::vector<std::uint64_t>{1, 2, 3, 4, 5, 6});
      }
    }
  }
}

SCENARIO("a given participant takes no options that are those of its domain") {
  const test::TestDomain domain;
  const auto participant = dds::ext::participant({.domain_id = domain.id()});
  const publication::PublisherOptions lossless{.qos_file = {}, .lossless = true, .record_folder = {}};
  CHECK_THROWS_AS(publication::SensorPublisher(participant, lossless), std::invalid_argument);
  const publication::PublisherOptions batch{.qos_file = {}, .batch = true, .record_folder = {}};
  CHECK_THROWS_AS(publication::SensorPublisher(participant, batch), std::invalid_argument);
}

SCENARIO("aiding of a beacon that another bridge numbers has no numbers and no status") {
  GIVEN("a source of headings of the body, and readers in another participant") {
    const test::TestDomain domain;
    const auto participant = dds::ext::participant({.domain_id = domain.id()});
    const dds::qos::Provider qos;
    auto headings = dds::topics::make_reader(participant, qos, dds::topics::heading);
    auto statuses = dds::topics::make_reader(participant, qos, dds::topics::beacon_status);
    publication::SensorPublisher node({.domain_id = domain.id()}, {.qos_file = {}, .record_folder = {}});
    std::vector<std::uint64_t> sequences;
    std::vector<BeaconAddress> with_status;
    ScriptedSource source([&](SampleSink& sink) {
      const auto send = [&sink](BeaconAddress address) {
        sink.on(PairHeading{.address = address, .valid = true, .flags = heading_flag_of_body});
      };
      REQUIRE(test::wait_until([&] {
        return headings.subscription_matched_status().current_count() == 1 &&
               statuses.subscription_matched_status().current_count() == 1;
      }));
      send(7);
      ImuSample own;
      own.address = 8;
      sink.on(own);
      send(8);
      REQUIRE(test::wait_until([&] {
        sink.tick();
        dds::ext::try_take_each(headings,
                                [&](const sonopose_PairHeading& heading, const dds::sub::SampleInfo&) {
                                  sequences.push_back(heading.event_sequence);
                                });
        dds::ext::try_take_each(statuses,
                                [&](const sonopose_BeaconStatus& status, const dds::sub::SampleInfo&) {
                                  with_status.push_back(status.address);
                                });
        return sequences.size() == 2 && !with_status.empty();
      }));
    });
    WHEN("it sends those of one beacon alone, and those of another one after its IMU samples") {
      node.run(source, process::StopSignal());
      THEN("only the latter are numbered and have a status") {
        CHECK(sequences == std::vector<std::uint64_t>{unnumbered, 2});
        CHECK(with_status == std::vector<BeaconAddress>(with_status.size(), 8));
      }
    }
  }
}

}  // namespace sonopose::bridge_node_test
