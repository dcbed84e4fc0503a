#include <sonopose/estimation/kalman/checkpoints.hpp>

#include <algorithm>
#include <numeric>

namespace sonopose::estimation::kalman {
namespace {

constexpr TimeNs dense_spacing_ns = 77'500'000;  // no multiple of a usual sample interval
constexpr TimeNs sparse_spacing_ns = 3 * dense_spacing_ns;
constexpr std::size_t dense_count = 4;
constexpr TimeNs reach_ns = 15 * dense_spacing_ns;  // more than the greatest age of a fix

}  // namespace

Checkpoints::Checkpoints() : slots_(capacity) {
  for (Checkpoint& slot : slots_) slot.state.bank.reserve();
  std::iota(order_.begin(), order_.end(), std::uint8_t{0});
}

bool Checkpoints::is_due(TimeNs time_ns) const {
  return empty() || time_ns - latest().state.imu.time_ns >= dense_spacing_ns;
}

void Checkpoints::add(const State& state, std::uint64_t next_imu) {
  if (count_ == capacity) remove(0);
  Checkpoint& next = slots_[order_[count_]];
  next.state = state;
  next.next_imu = next_imu;
  ++count_;
  // Thins the checkpoint that has just left the dense ones.
  if (count_ > dense_count + 1) {
    const std::size_t i = count_ - 1 - dense_count;
    if (time_ns(i) - time_ns(i - 1) < sparse_spacing_ns - dense_spacing_ns / 2) remove(i);
  }
  while (count_ > 1 && time_ns(count_ - 1) - time_ns(1) >= reach_ns) remove(0);
}

const Checkpoint& Checkpoints::rewind(TimeNs time_ns) {
  while (count_ > 1 && latest().state.imu.time_ns > time_ns) --count_;
  return latest();
}

bool Checkpoints::drop_oldest() {
  if (count_ < 2) return false;
  remove(0);
  return true;
}

/// Its slot becomes the next unused one.
void Checkpoints::remove(std::size_t i) {
  const auto removed = order_.begin() + static_cast<std::ptrdiff_t>(i);
  std::rotate(removed, removed + 1, order_.begin() + static_cast<std::ptrdiff_t>(count_));
  --count_;
}

}  // namespace sonopose::estimation::kalman
