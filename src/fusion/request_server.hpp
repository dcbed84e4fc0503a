#pragma once
/// \file
/// Answers requests to change settings.

#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/live_settings.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <thread>

namespace sonopose::fusion {

/// Takes requests on a separate thread. After each it pauses for as long as the answer took, so that a
/// flood of requests leaves what they lock to the poses; the reader keeps the latest requests meanwhile.
class RequestServer {
public:
  using Answer = std::function<std::optional<SettingsReply>(const SettingsRequest&)>;  ///< empty: no reply

  /// `answer` is called on that thread and must not throw.
  RequestServer(const dds::DomainParticipant& participant, const dds::qos::Provider& qos, Answer answer);
  RequestServer(const RequestServer&) = delete;
  RequestServer& operator=(const RequestServer&) = delete;
  ~RequestServer();

  /// Replies that were not written because a slow reader blocked.
  [[nodiscard]] std::uint64_t unwritten() const { return unwritten_; }

private:
  void serve(const std::stop_token& stop);

  Answer answer_;
  dds::DataWriter<sonopose_SettingsReply> replies_;
  dds::DataReader<sonopose_SettingsRequest> requests_;
  dds::GuardCondition stopping_;
  std::atomic<std::uint64_t> unwritten_ = 0;
  std::jthread thread_;
};

}  // namespace sonopose::fusion
