/// Parameter services with a real fusion, called like a client with rmw_cyclonedds.

#include "ros2/relay/parameter_server.hpp"

#include "clocks/clocks.hpp"
#include "fusion/fusion_node.hpp"
#include "support/test_domain.hpp"
#include "support/wait_until.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::parameter_server_test {

using test::wait_until;
using Texts = std::vector<std::string>;

constexpr std::chrono::seconds timeout{20};

/// A fusion that has received beacons 7 and 8 or 7 alone, and the node /sonopose with its services.
class System {
public:
  System(const System&) = delete;
  System& operator=(const System&) = delete;
  explicit System(const ros2::relay::OptionParameters& own_parameters = {},
                  const presence::AddressSet& addresses = {})
      : environment_(::unsetenv("CYCLONEDDS_URI")),
        fusion_(fusion_options()),
        participant_(dds::ext::participant(options())),
        imu_(dds::topics::make_writer(participant_, qos_, dds::topics::imu)),
        node_(participant_, qos_, ros2::NameResolver({}), ros2::Distro::jazzy),
        server_(node_, participant_,
                {.qos_file = {},
                 .startup_settings = {},
                 .own_parameters = own_parameters,
                 .addresses = addresses}) {
    server_.offer_services(node_, true);
    node_.announce();
    REQUIRE(wait_until([&] { return imu_.publication_matched_status().current_count() > 0; }));
    write_sample_of(7);
    if (addresses.first()) write_sample_of(8);
  }
  ~System() { stop_.request(); }
  dds::DomainOptions options() const { return {.domain_id = domain_.id()}; }

private:
  void write_sample_of(BeaconAddress address) {
    ImuSample sample;
    sample.address = address;
    sample.sensor_time_ns = clocks::host_now();
    sample.sequence = 1;
    imu_.write(dds::topics::to_idl(sample));
  }
  fusion::FusionOptions fusion_options() const {
    fusion::FusionOptions result;
    result.domain = options();
    return result;
  }

  int environment_;  // first, because the environment may set CYCLONEDDS_URI
  test::TestDomain domain_;
  fusion::FusionNode fusion_;
  dds::qos::Provider qos_;
  dds::domain::DomainParticipant participant_;
  dds::pub::DataWriter<sonopose_ImuSample> imu_;
  ros2::Node node_;
  ros2::relay::ParameterServer server_;
  process::StopSignal stop_;
  std::jthread fusing_{[this] { fusion_.run(stop_); }};
  std::jthread serving_{[this] {
    while (!stop_.wait_until(clocks::steady_now() + 2'000'000)) server_.serve();
  }};
};

/// A client like those of rmw_cyclonedds.
template <class S>
class Client {
public:
  Client(const System& system, const std::string& service) : Client(system.options(), service) {}
  Client(const dds::DomainOptions& domain, const std::string& service)
      : participant_(dds::ext::participant(domain)),
        requests_(dds::pub::Publisher(participant_), {participant_, "rq/sonopose/" + service + "Request"},
                  qos()),
        replies_(dds::sub::Subscriber(participant_), {participant_, "rr/sonopose/" + service + "Reply"},
                 qos()) {}

  /// Calls `check(const Response&)` with the reply to this client.
  template <class Check>
  void call(typename S::Request request, const Check& check) {
    REQUIRE(wait_until([&] {
      return requests_.publication_matched_status().current_count() > 0 &&
             replies_.subscription_matched_status().current_count() > 0;
    }));
    request.header = {.client = 4711, .sequence_number = ++number_};
    requests_.write(request);
    bool answered = false;
    REQUIRE(wait_until([&] {
      dds::ext::take_each(replies_, [&](const typename S::Response& response, const dds::sub::SampleInfo&) {
        if (response.header.client != 4711 || response.header.sequence_number != number_) return;
        answered = true;
        check(response);
      });
      return answered;
    }));
  }

private:
  static dds::Qos qos() {
    const std::string id = "clientid= 1.10.2;";
    return dds::Qos() << dds::policy::Reliability::Reliable() << dds::policy::History::KeepLast(10)
                      << dds::policy::UserData({id.begin(), id.end()});
  }

  dds::domain::DomainParticipant participant_;
  dds::pub::DataWriter<typename S::Request> requests_;
  dds::sub::DataReader<typename S::Response> replies_;
  std::int64_t number_ = 0;
};

/// Casts const away for idlc's strings, which nobody writes to.
char* borrow_string(const char* value) {
  return const_cast<char*>(value);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
}

/// A view of `names` as a sequence of idlc; `names` must outlive it.
struct Names {
  explicit Names(const Texts& names) {
    for (const auto& name : names) pointers.push_back(borrow_string(name.c_str()));
  }
  template <class Sequence>
  void assign_to(Sequence& sequence) {
    const auto length = static_cast<std::uint32_t>(pointers.size());
    sequence = {length, length, pointers.data(), false};
  }
  std::vector<char*> pointers;
};

/// Type and value of each parameter as text.
Texts values_of(Client<ros2::GetParameters>& client, const Texts& names) {
  Names view(names);
  ros2::GetParameters::Request request{};
  view.assign_to(request.names);
  Texts values;
  client.call(request, [&](const ros2::GetParameters::Response& response) {
    for (std::uint32_t i = 0; i < response.values._length; ++i) {
      const ros2::ParameterValue& value = response.values._buffer[i];
      const Texts known{
          "not set", value.bool_value ? "true" : "false", "integer " + std::to_string(value.integer_value),
          "double " + std::to_string(value.double_value), std::string("string ") + value.string_value};
      values.push_back(known.at(value.type));
    }
  });
  return values;
}

ros2::Parameter parameter(const char* name, std::uint8_t type, double number, const char* word = "") {
  ros2::Parameter result{};
  result.name = borrow_string(name);
  result.value.type = type;
  result.value.integer_value = static_cast<std::int64_t>(number);
  result.value.double_value = number;
  result.value.string_value = borrow_string(word);
  return result;
}

/// Repeats a request until no text of its reply, which `ask` returns, says that a busy fusion was too slow.
template <class Ask>
Texts answered(const Ask& ask) {
  Texts texts;
  REQUIRE(wait_until([&] {
    texts = ask();
    return std::none_of(texts.begin(), texts.end(), [](const std::string& text) {
      return text.find("no fusion") != std::string::npos;  // replied, or has reset a beacon
    });
  }));
  return texts;
}

/// Error of each assignment; empty on success.
Texts errors_of(Client<ros2::SetParameters>& client, std::vector<ros2::Parameter> parameters) {
  ros2::SetParameters::Request request{};
  const auto length = static_cast<std::uint32_t>(parameters.size());
  request.parameters = {length, length, parameters.data(), false};
  return answered([&] {
    Texts errors;
    client.call(request, [&](const ros2::SetParameters::Response& response) {
      for (std::uint32_t i = 0; i < response.results._length; ++i) {
        const auto& result = response.results._buffer[i];
        CHECK(result.successful == std::string(result.reason).empty());
        errors.emplace_back(result.reason);
      }
    });
    return errors;
  });
}

/// Message of the service reset.
std::string reset_by(Client<ros2::Trigger>& client) {
  return answered([&] {
           Texts message;
           client.call({}, [&](const ros2::Trigger::Response& response) {
             CHECK(response.success == std::string(response.message).starts_with("reset "));
             message = {response.message};
           });
           return message;
         })
      .front();
}

TEST_CASE("A client lists and reads the settings of all beacons and of each known beacon") {
  const System system;
  Client<ros2::ListParameters> list(system, "list_parameters");
  std::set<std::string> names;
  REQUIRE(wait_until([&] {
    list.call({}, [&](const auto& response) {
      names = {response.result.names._buffer, response.result.names._buffer + response.result.names._length};
    });
    return names.contains("beacon_7.documented.trust.n_min");
  }));
  CHECK(names.size() == 2 * settings::setting_table().size());

  Client<ros2::GetParameters> get(system, "get_parameters");
  const settings::Settings defaults;
  CHECK(values_of(get, {"documented.trust.n_min", "documented.trust.sigma_m", "no.such",
                        "documented.imu_weight", "beacon_9.documented.trust.n_min"}) ==
        Texts{"integer " + std::to_string(defaults.trust.n_min),
              "double " + std::to_string(defaults.trust.sigma_m), "not set", "string medium", "not set"});
}

TEST_CASE("A client reads description, type and range of a setting") {
  const System system;
  const Texts asked{"documented.trust.n_min", "no.such"};
  Names names(asked);
  Client<ros2::DescribeParameters> describe(system, "describe_parameters");
  ros2::DescribeParameters::Request request{};
  names.assign_to(request.names);
  describe.call(request, [](const auto& response) {
    REQUIRE(response.descriptors._length == 2);
    const auto& descriptor = response.descriptors._buffer[0];
    const auto& info = settings::setting_info("documented.trust.n_min");
    CHECK(descriptor.name == std::string("documented.trust.n_min"));
    CHECK(descriptor.type == 2);
    CHECK(std::string(descriptor.description).starts_with(info.sentence));
    REQUIRE(descriptor.integer_range._length == 1);
    CHECK(descriptor.integer_range._buffer[0].to_value == std::get<int>(info.maximum));
    CHECK(response.descriptors._buffer[1].type == 0);
  });

  Client<ros2::GetParameterTypes> types(system, "get_parameter_types");
  ros2::GetParameterTypes::Request types_request{};
  names.assign_to(types_request.names);
  REQUIRE(wait_until([&] {
    std::vector<int> found;
    types.call(types_request, [&](const auto& response) {
      found = {response.types._buffer, response.types._buffer + response.types._length};
    });
    return found == std::vector<int>{2, 0};
  }));
}

TEST_CASE("The options of the relay are read-only parameters") {
  const System system({{"map_frame", settings::SettingValue(std::string("hall"))},
                       {"use_sim_time", settings::SettingValue(false)},
                       {"topics", std::vector<std::string>{"odom", "pose"}},
                       {"mount", std::vector<double>{0.3, 0, 0, 0, 0, 90}}});
  Client<ros2::ListParameters> list(system, "list_parameters");
  list.call({}, [&](const auto& response) {
    const std::set<std::string> names{response.result.names._buffer,
                                      response.result.names._buffer + response.result.names._length};
    CHECK(names.contains("map_frame"));
    CHECK(names.contains("topics"));
  });
  Client<ros2::GetParameters> get(system, "get_parameters");
  CHECK(values_of(get, {"map_frame", "use_sim_time"}) == Texts{"string hall", "false"});
  const Texts asked{"topics", "mount"};
  Names names(asked);
  ros2::GetParameters::Request request{};
  names.assign_to(request.names);
  get.call(request, [](const auto& response) {
    REQUIRE(response.values._length == 2);
    CHECK(response.values._buffer[1].type == 8);
    REQUIRE(response.values._buffer[1].double_array_value._length == 6);
    CHECK(response.values._buffer[1].double_array_value._buffer[5] == 90);
    CHECK(response.values._buffer[0].type == 9);
    REQUIRE(response.values._buffer[0].string_array_value._length == 2);
    CHECK(response.values._buffer[0].string_array_value._buffer[1] == std::string("pose"));
  });
  Client<ros2::DescribeParameters> describe(system, "describe_parameters");
  ros2::DescribeParameters::Request described{};
  names.assign_to(described.names);
  describe.call(described, [](const auto& response) {
    REQUIRE(response.descriptors._length == 2);
    CHECK(response.descriptors._buffer[0].read_only);
    CHECK(response.descriptors._buffer[0].type == 9);
    CHECK(response.descriptors._buffer[1].type == 8);
  });
  Client<ros2::SetParameters> set(system, "set_parameters");
  CHECK(errors_of(set, {parameter("map_frame", 4, 0, "yard")}) ==
        Texts{"map_frame is read-only: restart sonopose-ros2 to change it"});
}

TEST_CASE("A client sets settings individually; invalid ones are rejected with the reason") {
  const System system;
  const settings::Settings defaults;
  Client<ros2::SetParameters> set(system, "set_parameters");
  const Texts errors = errors_of(
      set,
      {parameter("documented.trust.n_min", 2, 4), parameter("beacon_7.documented.trust.sigma_m", 3, 0.25),
       parameter("documented.trust.n_min", 2, -1), parameter("no.such", 2, 1),
       parameter("documented.trust.n_min", 9, 0), parameter("documented.imu_weight", 4, 0, "high")});
  REQUIRE(errors.size() == 6);
  CHECK(errors[0].empty());
  CHECK(errors[1].empty());
  CHECK_THAT(errors[2], Catch::Contains("documented.trust.n_min"));
  CHECK_THAT(errors[3], Catch::Contains("no.such"));
  CHECK_THAT(errors[4], Catch::Contains("an integer, a double or a string"));
  CHECK(errors[5].empty());
  Client<ros2::GetParameters> get(system, "get_parameters");
  const Texts asked{"documented.trust.n_min", "documented.imu_weight", "documented.trust.sigma_m"};
  CHECK(wait_until([&] {
    return values_of(get, asked) ==
           Texts{"integer 4", "string high", "double " + std::to_string(defaults.trust.sigma_m)};
  }));
}

TEST_CASE("Settings of one service request are one request to the fusion") {
  const System system;
  const auto listener = dds::ext::participant(system.options());
  auto requests = dds::topics::make_reader(listener, dds::qos::Provider(), dds::topics::settings_request);
  Client<ros2::SetParameters> set(system, "set_parameters");
  std::set<std::uint32_t> sizes;
  // Repeated, because the reader here may discover the writer of a request too late.
  REQUIRE(wait_until([&] {
    const Texts errors = errors_of(
        set, {parameter("documented.trust.n_min", 2, 4), parameter("no.such", 2, 1),
              parameter("documented.trust.sigma_m", 3, 0.25), parameter("documented.trust.n_min", 2, 5)});
    CHECK(errors.at(0).empty());
    CHECK_FALSE(errors.at(1).empty());
    dds::ext::take_each(requests,
                        [&](const sonopose_SettingsRequest& request, const dds::sub::SampleInfo& info) {
                          if (info.valid()) sizes.insert(request.assignments._length);
                        });
    return !sizes.empty();
  }));
  CHECK(sizes == std::set<std::uint32_t>{2});
  Client<ros2::GetParameters> get(system, "get_parameters");
  CHECK(wait_until([&] { return values_of(get, {"documented.trust.n_min"}) == Texts{"integer 5"}; }));
}

TEST_CASE("A request with too many names is refused with the reason and the limit") {
  const System system;
  Client<ros2::SetParameters> set(system, "set_parameters");
  const std::vector<ros2::Parameter> many(10'000, parameter("documented.trust.n_min", 2, 4));
  const Texts errors = errors_of(set, many);
  REQUIRE(errors.size() == many.size());
  CHECK(errors.front() == "the request has 10000 names, the limit is 1000");
  CHECK_FALSE(errors.back().empty());
  Client<ros2::SetParametersAtomically> set_atomically(system, "set_parameters_atomically");
  ros2::SetParametersAtomically::Request request{};
  std::vector<ros2::Parameter> copies = many;
  request.parameters = {10'000, 10'000, copies.data(), false};
  set_atomically.call(request,
                      [&](const auto& response) { CHECK(response.result.reason == errors.front()); });
  Client<ros2::GetParameters> get(system, "get_parameters");
  CHECK(values_of(get, Texts(10'000, "documented.trust.n_min")).empty());
  const Texts unchanged{"integer " + std::to_string(settings::Settings{}.trust.n_min)};
  CHECK(wait_until([&] { return values_of(get, {"documented.trust.n_min"}) == unchanged; }));
}

TEST_CASE("A client sets several settings atomically") {
  const System system;
  Client<ros2::SetParametersAtomically> set(system, "set_parameters_atomically");
  Client<ros2::GetParameters> get(system, "get_parameters");
  std::vector<ros2::Parameter> both{parameter("documented.trust.n_min", 2, 5),
                                    parameter("documented.trust.n_min", 2, -1)};
  ros2::SetParametersAtomically::Request request{};
  request.parameters = {2, 2, both.data(), false};
  set.call(request, [](const auto& response) { CHECK_FALSE(response.result.successful); });
  both[1] = parameter("beacon_7.documented.trust.n_min", 2, 5);
  set.call(request, [](const auto& response) {
    CHECK_THAT(response.result.reason, Catch::Contains("several beacons"));
  });
  CHECK(wait_until([&] { return values_of(get, {"documented.trust.n_min"}) != Texts{"not set"}; }));
  const int before = settings::Settings{}.trust.n_min;
  CHECK(values_of(get, {"documented.trust.n_min"}) == Texts{"integer " + std::to_string(before)});
  both[1] = parameter("documented.trust.sigma_m", 3, 0.75);
  const Texts errors = answered([&] {
    Texts error;
    set.call(request, [&](const auto& response) {
      error = {response.result.reason};
      CHECK(response.result.successful == error.front().empty());
    });
    return error;
  });
  CHECK(errors == Texts{""});
  CHECK(wait_until([&] {
    return values_of(get, {"documented.trust.n_min", "documented.trust.sigma_m"}) ==
           Texts{"integer 5", "double 0.750000"};
  }));
}

TEST_CASE("A client resets the fusion, and receives the addresses of the beacons") {
  const System system;
  Client<ros2::Trigger> reset(system, "reset");
  CHECK(reset_by(reset) == "reset 7");
}

TEST_CASE("A client receives an empty reply from a service that fails") {
  ::unsetenv("CYCLONEDDS_URI");
  const test::TestDomain domain;
  const dds::DomainOptions options{.domain_id = domain.id()};
  const dds::qos::Provider qos;
  ros2::Node node(dds::ext::participant(options), qos, ros2::NameResolver({}), ros2::Distro::jazzy);
  auto service = node.make_service<ros2::Trigger>("~/reset");
  node.announce();
  const std::jthread serving([&](const std::stop_token& end) {
    while (!end.stop_requested()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      try {
        service.serve(
            [](const auto& /*request*/, const auto& /*reply*/) { throw std::runtime_error("refused"); });
      } catch (const std::runtime_error&) {
      }
    }
  });
  Client<ros2::Trigger> client(options, "reset");
  client.call({}, [](const ros2::Trigger::Response& response) {
    CHECK_FALSE(response.success);
    CHECK(std::string(response.message).empty());
  });
}

TEST_CASE("With --addresses, a client lists, sets and resets these beacons and no others") {
  const System system({}, presence::AddressSet::parse("8"));
  Client<ros2::ListParameters> list(system, "list_parameters");
  std::set<std::string> names;
  REQUIRE(wait_until([&] {
    list.call({}, [&](const auto& response) {
      names = {response.result.names._buffer, response.result.names._buffer + response.result.names._length};
    });
    return names.contains("beacon_8.documented.trust.n_min");
  }));
  CHECK(names.contains("documented.trust.n_min"));
  CHECK_FALSE(names.contains("beacon_7.documented.trust.n_min"));
  Client<ros2::SetParameters> set(system, "set_parameters");
  const Texts errors = errors_of(set, {parameter("beacon_7.documented.trust.n_min", 2, 4),
                                       parameter("beacon_8.documented.trust.n_min", 2, 4)});
  CHECK(errors == Texts{"beacon_7.documented.trust.n_min: beacon 7 is not one of --addresses", ""});
  Client<ros2::Trigger> reset(system, "reset");
  CHECK(reset_by(reset) == "reset 8");
}

TEST_CASE("A client without a reply reader does not block others") {
  const System system;
  const auto deaf = dds::ext::participant(system.options());
  dds::pub::DataWriter<ros2::ListParameters::Request> writer(
      dds::pub::Publisher(deaf), {deaf, "rq/sonopose/list_parametersRequest"},
      dds::Qos() << dds::policy::Reliability::Reliable());
  REQUIRE(wait_until([&] { return writer.publication_matched_status().current_count() > 0; }));
  writer.write({});
  Client<ros2::ListParameters> list(system, "list_parameters");
  list.call({}, [](const auto&) {});
}

TEST_CASE("Settings of ever more beacons are ignored") {
  const System system;
  Client<ros2::ListParameters> list(system, "list_parameters");
  const auto count_beacons = [&list] {
    std::ptrdiff_t count = 0;
    list.call({}, [&count](const auto& response) {
      const auto& names = response.result.names;
      count = std::count_if(names._buffer, names._buffer + names._length, [](const std::string& name) {
        return name.starts_with("beacon_") && name.ends_with(".trust.n_min");
      });
    });
    return count;
  };
  REQUIRE(wait_until([&] { return count_beacons() == 1; }));
  const auto hostile = dds::ext::participant(system.options());
  auto writer = dds::topics::make_writer(hostile, dds::qos::Provider(), dds::topics::settings);
  REQUIRE(wait_until([&] { return writer.publication_matched_status().current_count() > 0; }));
  EffectiveSettings forged{.values = {{"documented.trust.n_min", "4"}}};
  for (forged.address = 1000; forged.address < 1300; ++forged.address) {
    forged.values.front().value =
        forged.address % 2 == 0 ? "nonsense" : "4";  // must not end the reading process
    writer.write(dds::topics::to_idl(forged).sample());
  }
  REQUIRE(dds::ext::wait_for_acknowledgments(writer, timeout));
  // Its own beacon and 255 others, half of which have an invalid value.
  REQUIRE(wait_until([&] { return count_beacons() >= 128; }));
  CHECK(count_beacons() == 128);
}

}  // namespace sonopose::parameter_server_test
