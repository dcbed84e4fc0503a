#include "bridge/bridge_publisher.hpp"
#include "process/clocks.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>

namespace sonopose::bridge {

void BridgeNode::Publisher::wait_for_readers() {
  const auto all_matched = [this] {
    return imu_writer_.publication_matched_status().current_count > 0 &&
           fix_writer_.publication_matched_status().current_count > 0 &&
           heading_writer_.publication_matched_status().current_count > 0;
  };
  constexpr TimeNs look_period_ns = 20'000'000;
  constexpr TimeNs timeout_ns = 3'000'000'000;
  const SteadyTime began = process::steady_now();
  bool told = false;
  while (!all_matched()) {
    if (stop_->wait_until(process::steady_now() + look_period_ns)) return;
    if (!told && process::steady_now() - began > timeout_ns) {
      fmt::print(stderr, "sonopose-bridge: waiting for somebody to listen (is sonopose-fusion running?)\n");
      told = true;
    }
  }
}

void BridgeNode::Publisher::wait_until_read() {
  const auto wait = [this](auto& writer) {
    constexpr std::chrono::milliseconds step{200};
    constexpr int most_steps = 150;
    for (int i = 0; i < most_steps && !stopped(); ++i) {
      if (writer.wait_for_acknowledgments(step)) return;
    }
  };
  wait(imu_writer_);
  wait(fix_writer_);
  wait(heading_writer_);
  wait(truth_writer_);
}

BridgeNode::BridgeNode(const BridgeOptions& options) : publisher_(std::make_unique<Publisher>(options)) {}
BridgeNode::~BridgeNode() = default;

void BridgeNode::run(Source& source, const process::StopSignal& stop) {
  publisher_->obey(stop);
  if (source.is_recording()) publisher_->wait_for_readers();
  source.run(*publisher_, stop);
  publisher_->publish_statuses(process::steady_now());
  publisher_->flush();
  if (source.is_recording()) publisher_->wait_until_read();
}

}  // namespace sonopose::bridge
