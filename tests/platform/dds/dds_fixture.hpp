#pragma once
// Shared by the tests of the DDS layer: a private domain, and waiting for events.

#include "support/test_domain.hpp"
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace sonopose::dds::test {

/// Upper bound; every wait ends with its event.
inline constexpr Duration test_timeout = std::chrono::minutes(3);

/// Domain of this process alone.
inline std::uint32_t test_domain() {
  static const sonopose::test::TestDomain domain;
  return domain.id();
}

/// A participant on loopback.
inline DomainParticipant participant() {
  return make_participant({.domain_id = test_domain()});
}

/// Waits on the entity's statuses until `done()`. Returns the last value of `done()`.
template <class Done>
bool wait_for(const Entity& entity, StatusMask statuses, Done done, Duration timeout = test_timeout) {
  StatusCondition condition(entity);
  condition.enabled_statuses(statuses);
  WaitSet waitset;
  waitset += condition;
  const auto give_up = std::chrono::steady_clock::now() + timeout;
  while (!done()) {
    const Duration left = give_up - std::chrono::steady_clock::now();
    if (left <= Duration::zero() || waitset.wait(left) == 0) return done();
  }
  return true;
}

/// Waits until the reader has matched `count` writers.
template <class T>
bool matched(DataReader<T>& reader, std::uint32_t count = 1) {
  return wait_for(reader, StatusMask::subscription_matched(),
                  [&] { return reader.subscription_matched_status().current_count == count; });
}

/// Takes until there are `count` samples with data.
template <class T>
std::vector<T> take_samples(DataReader<T>& reader, std::size_t count) {
  std::vector<T> samples;
  wait_for(reader, StatusMask::data_available(), [&] {
    reader.take_each([&](const T& sample, const SampleInfo&) { samples.push_back(sample); });
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
  Environment(Environment&&) = delete;
  Environment& operator=(Environment&&) = delete;
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
