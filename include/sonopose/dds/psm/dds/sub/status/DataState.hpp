#pragma once
/// \file
/// States of samples, which select those to read. Left out: the `>>` of DataState.

#include <bitset>
#include <cstdint>

namespace dds::inline sonopose_psm::sub::status {

namespace detail {
/// A set of states of one kind.
template <class Kind>
class State : public std::bitset<32> {
public:
  using MaskType = std::bitset<32>;
  State() = default;
  explicit State(std::uint32_t bits) : bitset(bits) {}
  State(const MaskType& bits) : bitset(bits) {}
  static const Kind any() { return Kind(0xffffU); }
};
}  // namespace detail

/// States of a sample: read before, or not.
class SampleState : public detail::State<SampleState> {
public:
  using State::State;
  SampleState(const State& state) : State(state) {}
  static const SampleState read() { return SampleState(1U); }
  static const SampleState not_read() { return SampleState(2U); }
};

/// States of an instance to a reader: seen before, or new.
class ViewState : public detail::State<ViewState> {
public:
  using State::State;
  ViewState(const State& state) : State(state) {}
  static const ViewState new_view() { return ViewState(1U); }
  static const ViewState not_new_view() { return ViewState(2U); }
};

/// States of an instance: alive, disposed of, or without writers.
class InstanceState : public detail::State<InstanceState> {
public:
  using State::State;
  InstanceState(const State& state) : State(state) {}
  static const InstanceState alive() { return InstanceState(1U); }
  static const InstanceState not_alive_disposed() { return InstanceState(2U); }
  static const InstanceState not_alive_no_writers() { return InstanceState(4U); }
  static const InstanceState not_alive_mask() { return InstanceState(6U); }
};

/// The three together.
class DataState {
public:
  DataState() = default;
  DataState(const SampleState& sample) : sample_(sample) {}
  DataState(const ViewState& view) : view_(view) {}
  DataState(const InstanceState& instance) : instance_(instance) {}
  DataState(const SampleState& sample, const ViewState& view, const InstanceState& instance)
      : sample_(sample), view_(view), instance_(instance) {}

  static DataState any() { return {}; }
  static DataState new_data() { return {SampleState::not_read(), ViewState::any(), InstanceState::alive()}; }
  static DataState any_data() { return InstanceState::alive(); }
  static DataState new_instance() {
    return {SampleState::any(), ViewState::new_view(), InstanceState::alive()};
  }

  const SampleState& sample_state() const { return sample_; }
  void sample_state(const SampleState& state) { sample_ = state; }
  const ViewState& view_state() const { return view_; }
  void view_state(const ViewState& state) { view_ = state; }
  const InstanceState& instance_state() const { return instance_; }
  void instance_state(const InstanceState& state) { instance_ = state; }

  DataState& operator<<(const SampleState& state) {
    sample_ = state;
    return *this;
  }
  DataState& operator<<(const ViewState& state) {
    view_ = state;
    return *this;
  }
  DataState& operator<<(const InstanceState& state) {
    instance_ = state;
    return *this;
  }
  bool operator==(const DataState&) const = default;

  /// Beyond the PSM: the mask in C, and from it.
  std::uint32_t c_mask() const {
    const auto bits = [](const std::bitset<32>& state, std::uint32_t known) {
      return static_cast<std::uint32_t>(state.to_ulong()) & known;
    };
    return bits(sample_, 3) | bits(view_, 3) << 2U | bits(instance_, 7) << 4U;
  }
  static DataState of_c_mask(std::uint32_t mask) {
    return {SampleState(mask & 3U), ViewState(mask >> 2U & 3U), InstanceState(mask >> 4U & 7U)};
  }

private:
  SampleState sample_ = SampleState::any();
  ViewState view_ = ViewState::any();
  InstanceState instance_ = InstanceState::any();
};

}  // namespace dds::inline sonopose_psm::sub::status
