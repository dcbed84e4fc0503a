#pragma once
// Shared by the tests of the PSM: a private domain, a pair of endpoints, and waiting for events. Comparisons
// are CHECK((a == b)), since Catch would print the operands, and an InstanceHandle of cyclonedds-cxx takes
// anything.

#include "psm_types.hpp"
#include "support/test_domain.hpp"

#include <dds/dds.hpp>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

namespace psm_fixture {

using psm_test::Sample;

/// Upper bound; every wait ends with its event.
inline const dds::core::Duration timeout = dds::core::Duration::from_secs(180.0);

/// Domain of this process alone, on loopback.
inline std::uint32_t domain_id() {
#ifdef __OMG_DDS_DDS_HPP__  // cyclonedds-cxx
  setenv("CYCLONEDDS_URI", "file://" SONOPOSE_SOURCE_DIR "/config/cyclonedds-loopback.xml", 1);
#endif
  static const sonopose::test::TestDomain domain;
  return domain.id();
}

/// Returns true when `done()` is, and false after the timeout.
template <class Done>
bool wait_until(Done done) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(3);
  while (!done()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

inline Sample sample(std::int32_t id, const std::string& code = "") {
  Sample result;
  result.id(id);
  result.code(code);
  return result;
}

inline dds::sub::qos::DataReaderQos reliable_reader(std::uint32_t depth = 16) {
  return dds::sub::qos::DataReaderQos()
         << dds::core::policy::Reliability::Reliable() << dds::core::policy::History::KeepLast(depth);
}

inline dds::pub::qos::DataWriterQos reliable_writer(std::uint32_t depth = 16) {
  return dds::pub::qos::DataWriterQos() << dds::core::policy::History::KeepLast(depth);
}

/// A participant with a topic, a writer and a reader. Samples of one process arrive within `write`.
struct Bus {
  dds::domain::DomainParticipant participant{domain_id()};
  dds::topic::Topic<Sample> topic{participant, "psm"};
  dds::pub::Publisher publisher{participant};
  dds::sub::Subscriber subscriber{participant};
  dds::pub::DataWriter<Sample> writer{publisher, topic, reliable_writer()};
  dds::sub::DataReader<Sample> reader{subscriber, topic, reliable_reader()};

  Bus() {
    wait_until([this] {
      return writer.publication_matched_status().current_count() == 1 &&
             reader.subscription_matched_status().current_count() == 1;
    });
  }
};

inline std::vector<std::string> codes(const dds::sub::LoanedSamples<Sample>& samples) {
  std::vector<std::string> result;
  for (const auto& each : samples) {
    if (each.info().valid()) result.push_back(each.data().code());
  }
  return result;
}

using Codes = std::vector<std::string>;

}  // namespace psm_fixture
