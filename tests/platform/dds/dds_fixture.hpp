#pragma once
// Shared by the tests of the DDS layer: a private domain, and waiting for events.

#include "support/test_domain.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace sonopose::dds::test {

/// Upper bound; every wait ends with its event.
inline constexpr std::chrono::nanoseconds test_timeout = std::chrono::minutes(3);

/// Domain of this process alone.
inline std::uint32_t test_domain() {
  static const sonopose::test::TestDomain domain;
  return domain.id();
}

/// A participant on loopback.
inline domain::DomainParticipant participant() {
  return ext::participant({.domain_id = test_domain()});
}

/// Waits on the entity's statuses until `done()`. Returns the last value of `done()`.
template <class Done>
bool wait_for(const core::Entity& entity, core::status::StatusMask statuses, Done done,
              std::chrono::nanoseconds timeout = test_timeout) {
  core::cond::StatusCondition condition(entity);
  condition.enabled_statuses(statuses);
  core::cond::WaitSet waitset;
  waitset += condition;
  const auto give_up = std::chrono::steady_clock::now() + timeout;
  while (!done()) {
    const std::chrono::nanoseconds left = give_up - std::chrono::steady_clock::now();
    if (left <= std::chrono::nanoseconds::zero() || !ext::wait(waitset, left)) return done();
  }
  return true;
}

/// Waits until the reader has matched `count` writers.
template <class T>
bool matched(sub::DataReader<T>& reader, std::int32_t count = 1) {
  return wait_for(reader, core::status::StatusMask::subscription_matched(),
                  [&] { return reader.subscription_matched_status().current_count() == count; });
}

/// Takes until there are `count` samples with data.
template <class T>
std::vector<T> take_samples(sub::DataReader<T>& reader, std::size_t count) {
  std::vector<T> samples;
  wait_for(reader, core::status::StatusMask::data_available(), [&] {
    ext::take_each(reader, [&](const T& sample, const sub::SampleInfo&) { samples.push_back(sample); });
    return samples.size() >= count;
  });
  return samples;
}

/// A reset command, the smallest native type, for tests that need any sample.
inline sonopose_ResetCommand command(std::uint16_t address, std::uint64_t request_id) {
  return {.address = address, .request_id = request_id};
}

/// Sets an environment variable during its lifetime (nullptr unsets it).
class Environment {
public:
  Environment(const char* name, const char* value) : name_(name) {
    const char* before = std::getenv(name);
    had_ = before != nullptr;
    if (had_) before_ = before;
    set(value);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() { set(had_ ? before_.c_str() : nullptr); }

private:
  void set(const char* value) const {
    if (value != nullptr) {
      setenv(name_.c_str(), value, 1);
    } else {
      unsetenv(name_.c_str());
    }
  }

  std::string name_;
  std::string before_;
  bool had_ = false;
};

/// The project's profiles, regardless of SONOPOSE_QOS.
inline qos::Provider project_qos() {
  const Environment environment("SONOPOSE_QOS", nullptr);
  return qos::Provider();
}

}  // namespace sonopose::dds::test
