#include "fusion/request_server.hpp"

#include "clocks/clocks.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <chrono>
#include <utility>

namespace sonopose::fusion {

RequestServer::RequestServer(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                             Answer answer)
    : answer_(std::move(answer)),
      replies_(dds::topics::make_writer(participant, qos, dds::topics::settings_reply)),
      requests_(dds::topics::make_reader(participant, qos, dds::topics::settings_request)),
      thread_([this](const std::stop_token& stop) { serve(stop); }) {}

RequestServer::~RequestServer() {
  thread_.request_stop();
  stopping_.trigger_value(true);
}

void RequestServer::serve(const std::stop_token& stop) {
  const dds::ReadCondition has_requests(requests_);
  dds::WaitSet waitset;
  waitset += has_requests;
  waitset += stopping_;
  while (!stop.stop_requested()) {
    waitset.wait();
    requests_.try_take_each([&](const sonopose_SettingsRequest& request, const dds::SampleInfo&) {
      if (stop.stop_requested()) return;
      const SteadyTime begin = clocks::steady_now();
      const auto reply = answer_(dds::topics::from_idl(request));
      if (reply && replies_.try_write(dds::topics::to_idl(*reply)) < 0) ++unwritten_;
      std::this_thread::sleep_for(std::chrono::nanoseconds(clocks::steady_now() - begin));
    });
  }
}

}  // namespace sonopose::fusion
