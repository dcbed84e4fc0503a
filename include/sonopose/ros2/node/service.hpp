#pragma once
/// \file
/// A service for clients with rmw_cyclonedds. They put client id and sequence number into a header of the
/// request and expect them in the header of the reply. (Clients of other middlewares use RTPS fields that the
/// C API of Cyclone DDS does not set.)

#include <sonopose/dds/psm/ext.hpp>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::ros2 {

/// Client of a service's endpoint: the client id in its user data, otherwise its participant.
std::string client_of(const std::vector<std::uint8_t>& user_data, const dds_guid_t& participant);

/// A service; `S` has the types Request and Response. Not thread-safe; do not call it from a listener.
template <class S>
class Service {
public:
  using Request = typename S::Request;
  using Response = typename S::Response;

  /// Calls `on_request` when a request arrives, under the rules of a listener.
  class RequestListener final : public dds::sub::NoOpDataReaderListener<Request> {
  public:
    explicit RequestListener(std::function<void()> on_request) : on_request_(std::move(on_request)) {}
    void on_data_available(dds::sub::DataReader<Request>& /*requests*/) noexcept override { on_request_(); }

  private:
    std::function<void()> on_request_;
  };

  /// `listener` is that of `requests`; may be null.
  Service(std::unique_ptr<RequestListener> listener, dds::sub::DataReader<Request> requests,
          dds::pub::DataWriter<Response> replies)
      : listener_(std::move(listener)), requests_(std::move(requests)), replies_(std::move(replies)) {}

  /// Calls `handle(const Request&, reply)` for every pending request. `handle` calls `reply(Response)` once;
  /// the header is filled in here. If the reply reader of a client is not discovered yet, requests wait for
  /// at most `max_waits` later calls. A client without a reader therefore does not block others. Returns true
  /// if requests wait. If `handle` throws before it replies, the reply is empty; the last exception is thrown
  /// after all requests are handled.
  template <class Handle>
  bool serve(const Handle& handle) {
    for (const auto& sample : requests_.select().max_samples(max_pending).read()) {
      const bool waits = sample.info().valid() && !has_reply_reader(sample.info().publication_handle());
      if (waits && ++waits_ < max_waits) return true;
    }
    waits_ = 0;
    std::exception_ptr error;
    dds::ext::take_each(requests_, [&](const Request& request, const dds::sub::SampleInfo&) {
      bool has_replied = false;
      const auto reply = [&](Response response) {
        response.header = request.header;
        dds::ext::try_write(replies_, response);
        has_replied = true;
      };
      try {
        handle(request, reply);
      } catch (...) {  // the client waits for a reply
        if (!has_replied) reply({});
        error = std::current_exception();
      }
    });
    if (error) std::rethrow_exception(error);
    return false;
  }

  const dds::sub::DataReader<Request>& requests() const { return requests_; }
  const dds::pub::DataWriter<Response>& replies() const { return replies_; }

private:
  static constexpr std::uint32_t max_pending = 32;
  static constexpr int max_waits = 25;

  bool has_reply_reader(dds::core::InstanceHandle request_writer) const {
    const auto writer = dds::ext::matched_publication_data(requests_, request_writer);
    if (!writer) return true;  // the client has gone: remove its request
    const std::string client = client_of(writer->user_data, writer->participant_key);
    const auto readers = dds::ext::matched_subscriptions(replies_);
    return std::any_of(readers.begin(), readers.end(), [&](const dds::core::InstanceHandle& each) {
      const auto reader = dds::ext::matched_subscription_data(replies_, each);
      return reader && client_of(reader->user_data, reader->participant_key) == client;
    });
  }

  std::unique_ptr<RequestListener> listener_;
  dds::sub::DataReader<Request> requests_;
  dds::pub::DataWriter<Response> replies_;
  int waits_ = 0;
};

}  // namespace sonopose::ros2
