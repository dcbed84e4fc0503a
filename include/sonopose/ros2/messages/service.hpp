#pragma once
/// \file
/// A service of a node's, for clients on rmw_cyclonedds: it puts who asks, and a number, in front of a
/// request, and looks for both in front of the reply. (Other middlewares' clients look for them elsewhere,
/// where Cyclone's C interface does not put them.)

#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/binding/data_writer.hpp>

#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Who stands behind an end of a service: the client's own id where its user data holds one, else its
/// process.
std::string client_of(const std::vector<std::uint8_t>& user_data, const dds_guid_t& participant);

/// `S` has a Request and a Response. For one thread at a time, which is not a listener's.
template <class S>
class Service {
public:
  using Request = typename S::Request;
  using Response = typename S::Response;

  Service(dds::DataReader<Request> requests, dds::DataWriter<Response> replies)
      : requests_(std::move(requests)), replies_(std::move(replies)) {}

  /// Calls `answer(const Request&, reply)` for every request that has come and whose client can hear; it
  /// calls `reply(Response)` once, whose header is filled in here. Requests of clients that are not known as
  /// readers yet wait for later calls, but for no more than `most_waits`: one that never listens shall not
  /// hold others up.
  template <class Answer>
  void serve(const Answer& answer) {
    for (const auto sample : requests_.read(most)) {
      const bool waits = sample.info().valid() && !can_hear(sample.info().publication_handle());
      if (waits && ++waits_ < most_waits) return;
    }
    waits_ = 0;
    requests_.take_each([&](const Request& request, const dds::SampleInfo&) {
      answer(request, [&](Response response) {
        response.header = request.header;
        replies_.try_write(response);
      });
    });
  }

private:
  static constexpr std::size_t most = 32;
  static constexpr int most_waits = 25;

  bool can_hear(dds::InstanceHandle request_writer) const {
    try {
      const auto asker = requests_.matched_publication_data(request_writer);
      const std::string client = client_of(asker.user_data, asker.participant_key);
      for (const dds::InstanceHandle reader : replies_.matched_subscriptions()) {
        const auto listener = replies_.matched_subscription_data(reader);
        if (client_of(listener.user_data, listener.participant_key) == client) return true;
      }
      return false;
    } catch (const dds::Error&) {
      return true;  // gone meanwhile: the request shall go too
    }
  }

  dds::DataReader<Request> requests_;
  dds::DataWriter<Response> replies_;
  int waits_ = 0;
};

}  // namespace sonopose::ros2
