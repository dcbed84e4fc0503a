#pragma once
/// \file
/// The bus of one test: a private domain, the real programs on it, and the test's consumers.

#include "support/process.hpp"
#include "support/test_domain.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::test {

using Stream = Process::Stream;
using Arguments = std::vector<std::string>;

/// Clears variables that would change the behaviour of the programs under test.
inline const Environment neutral{
    {"CYCLONEDDS_URI", ""}, {"SONOPOSE_QOS", ""}, {"ROS_DOMAIN_ID", ""}, {"ROS_DISTRO", ""}};

class Bus {
public:
  Bus() {
    for (const auto& entry : neutral) ::unsetenv(entry.first.c_str());
  }

  [[nodiscard]] std::uint32_t domain_id() const { return domain_.id(); }

  std::unique_ptr<Process> bridge(const Arguments& arguments) const {
    return start(SONOPOSE_TEST_BRIDGE, arguments);
  }
  std::unique_ptr<Process> monitor(const Arguments& arguments) const {
    return start(SONOPOSE_TEST_MONITOR, arguments);
  }
  std::unique_ptr<Process> play(const Arguments& arguments) const {
    return start(SONOPOSE_TEST_PLAY, arguments);
  }
  std::unique_ptr<Process> record(const Arguments& arguments) const {
    return start(SONOPOSE_TEST_RECORD, arguments);
  }
  /// Runs sonopose-settings until it exits.
  Result settings(Arguments arguments) const {
    arguments.insert(arguments.end(), {"--domain", std::to_string(domain_.id())});
    // The default is too short for a busy machine.
    if (std::find(arguments.begin(), arguments.end(), "--timeout") == arguments.end()) {
      arguments.insert(arguments.end(), {"--timeout", "120"});
    }
    return run(SONOPOSE_TEST_SETTINGS, arguments);
  }
  /// Runs until it receives a signal.
  std::unique_ptr<Process> settings_watch(const Arguments& arguments = {}) const {
    Arguments all{"watch"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return start(SONOPOSE_TEST_SETTINGS, all);
  }
  /// Returns once it is serving.
  std::unique_ptr<Process> fusion(const Arguments& arguments = {}) const {
    auto fusion = start(SONOPOSE_TEST_FUSION, arguments);
    REQUIRE(fusion->wait_for_line(Stream::error, "serving"));
    return fusion;
  }

  /// Returns once it is relaying.
  std::unique_ptr<Process> ros2(Arguments arguments = {}) const {
    arguments.insert(arguments.end(), {"--network", "loopback"});
    auto relay = start(SONOPOSE_TEST_ROS2, arguments);
    REQUIRE(relay->wait_for_line(Stream::error, "relaying as"));
    return relay;
  }

private:
  [[nodiscard]] std::unique_ptr<Process> start(const char* program, Arguments arguments) const {
    arguments.insert(arguments.end(), {"--domain", std::to_string(domain_.id())});
    return std::make_unique<Process>(program, arguments);
  }

  TestDomain domain_;
};

/// Waits on an entity's statuses until `done()`; returns the last result of `done()`.
template <class Done>
bool wait_for_status(const dds::core::Entity& entity, dds::core::status::StatusMask statuses,
                     const Done& done, std::chrono::milliseconds limit = timeout) {
  dds::core::cond::StatusCondition condition(entity);
  condition.enabled_statuses(statuses);
  dds::core::cond::WaitSet waitset;
  waitset += condition;
  const auto give_up = std::chrono::steady_clock::now() + limit;
  while (!done()) {
    const std::chrono::nanoseconds left = give_up - std::chrono::steady_clock::now();
    if (left <= std::chrono::nanoseconds::zero() || !dds::ext::wait(waitset, left)) return done();
  }
  return true;
}

/// A consumer of one topic that receives all samples. Samples of a live writer expire, so take them every few
/// seconds. It has its own participant, like a separate program.
template <class T>
class Consumer {
public:
  using Sample = decltype(dds::topics::from_idl(std::declval<const T&>()));

  Consumer(const Bus& bus, const dds::topics::Entry<T>& entry,
           dds::topics::Delivery delivery = dds::topics::Delivery::lossless)
      : participant_(dds::ext::participant({.domain_id = bus.domain_id()})),
        reader_(dds::topics::make_reader(participant_, dds::qos::Provider(), entry, nullptr, delivery)) {}

  /// Waits until it has matched at least `count` writers.
  bool wait_for_writers(std::int32_t count = 1) {
    return wait_for_status(reader_, dds::core::status::StatusMask::subscription_matched(),
                           [&] { return reader_.subscription_matched_status().current_count() >= count; });
  }

  /// Takes samples until `done()`.
  template <class Done>
  bool wait_until(const Done& done, std::chrono::milliseconds limit = timeout) {
    return wait_for_status(
        reader_, dds::core::status::StatusMask::data_available(),
        [&] {
          take();
          return done();
        },
        limit);
  }

  /// Takes samples until there are `count` in total.
  bool wait_for_count(std::size_t count, std::chrono::milliseconds limit = timeout) {
    return wait_until([&] { return samples.size() >= count; }, limit);
  }

  /// Takes samples until there are `count` more.
  bool wait_for_more(std::size_t count) { return wait_for_count(samples.size() + count); }

  /// Takes samples until one fulfils `predicate`, including those already taken from index `from` on.
  template <class Predicate>
  bool wait_for(const Predicate& predicate, std::size_t from = 0, std::chrono::milliseconds limit = timeout) {
    return wait_until(
        [&] {
          for (; from < samples.size(); ++from) {
            if (predicate(samples[from])) return true;
          }
          return false;
        },
        limit);
  }

  /// Takes all available samples.
  void take() {
    dds::ext::take_each(reader_, [&](const T& sample, const dds::sub::SampleInfo&) {
      samples.push_back(dds::topics::from_idl(sample));
      received_ns.push_back(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                std::chrono::system_clock::now().time_since_epoch())
                                .count());
    });
  }

  std::vector<Sample> samples;
  std::vector<TimeNs> received_ns;  ///< time at which each sample was taken

private:
  dds::domain::DomainParticipant participant_;
  dds::sub::DataReader<T> reader_;
};

}  // namespace sonopose::test
