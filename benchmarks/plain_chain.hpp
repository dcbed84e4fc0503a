#pragma once
// The lower bound without DDS: source → relay → sink over plain UDP sockets, with the size of the real
// payloads.

#include <sonopose/samples/samples.hpp>

#include <functional>

struct sonopose_FusedPose;

namespace sonopose::benchmarks {

class LoopbackSocket {
public:
  /// Binds to a free port of 127.0.0.1. Throws std::system_error.
  LoopbackSocket();
  LoopbackSocket(const LoopbackSocket&) = delete;
  LoopbackSocket& operator=(const LoopbackSocket&) = delete;
  ~LoopbackSocket();

  /// Sets the destination. Throws std::system_error.
  void connect(const LoopbackSocket& other);

  [[nodiscard]] int file() const { return file_; }

private:
  int file_;
};

/// Sends IMU samples at `rate_hz` until the process is killed.
void run_plain_source(const LoopbackSocket& out, double rate_hz);

/// Sends a pose with the stamps of each received IMU sample until the process is killed.
void run_plain_relay(const LoopbackSocket& in, const LoopbackSocket& out);

/// Passes each pose and its time of receipt to `on_pose` until `ended()`, which is polled ten times per
/// second.
void take_plain_poses(const LoopbackSocket& in, const std::function<bool()>& ended,
                      const std::function<void(const sonopose_FusedPose&, TimeNs)>& on_pose);

}  // namespace sonopose::benchmarks
