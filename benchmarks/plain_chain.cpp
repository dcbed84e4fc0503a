#include "plain_chain.hpp"

#include "clocks/clocks.hpp"
#include "pulse.hpp"
#include <sonopose/idl/sonopose.h>

#include <arpa/inet.h>
#include <cerrno>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <system_error>
#include <unistd.h>

namespace sonopose::benchmarks {
namespace {

void check(const char* call, int code) {
  if (code < 0) throw std::system_error(errno, std::generic_category(), call);
}

}  // namespace

LoopbackSocket::LoopbackSocket() : file_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  check("socket", file_);
  sockaddr_in any_port{};
  any_port.sin_family = AF_INET;
  any_port.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  check("bind", ::bind(file_, reinterpret_cast<const sockaddr*>(&any_port), sizeof any_port));
  const timeval tenth{0, 100'000};
  check("setsockopt", ::setsockopt(file_, SOL_SOCKET, SO_RCVTIMEO, &tenth, sizeof tenth));
}

LoopbackSocket::~LoopbackSocket() {
  ::close(file_);
}

void LoopbackSocket::connect(const LoopbackSocket& other) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  check("getsockname", ::getsockname(other.file_, reinterpret_cast<sockaddr*>(&address), &size));
  check("connect", ::connect(file_, reinterpret_cast<const sockaddr*>(&address), size));
}

void run_plain_source(const LoopbackSocket& out, double rate_hz) {
  run_source(rate_hz, [&out](const sonopose_ImuSample& imu) { ::send(out.file(), &imu, sizeof imu, 0); });
}

void run_plain_relay(const LoopbackSocket& in, const LoopbackSocket& out) {
  sonopose_ImuSample imu{};
  while (true) {
    if (::recv(in.file(), &imu, sizeof imu, 0) != sizeof imu) continue;
    sonopose_FusedPose pose{};
    pose.fusion_in_time = clocks::host_now();
    pose.address = imu.address;
    pose.event_sequence = imu.event_sequence;
    pose.time = imu.sensor_time;
    pose.imu_bridge_time = imu.bridge_time;
    pose.fusion_out_time = clocks::host_now();
    ::send(out.file(), &pose, sizeof pose, 0);
  }
}

void take_plain_poses(const LoopbackSocket& in, const std::function<bool()>& ended,
                      const std::function<void(const sonopose_FusedPose&, TimeNs)>& on_pose) {
  sonopose_FusedPose pose{};
  while (!ended()) {
    const bool received = ::recv(in.file(), &pose, sizeof pose, 0) == sizeof pose;
    if (received) on_pose(pose, clocks::host_now());
  }
}

}  // namespace sonopose::benchmarks
