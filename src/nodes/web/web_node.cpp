#include "web/web_node.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "observation/bus/bus_watch.hpp"
#include "observation/bus/views_json.hpp"
#include "presence/beacon_admission.hpp"
#include "process/service.hpp"
#include "security/enclave.hpp"
#include "threads/mutex.hpp"
#include "transitions/transition_log.hpp"
#include "web/foxglove/topic_feed.hpp"
#include "web/live/event_json.hpp"
#include "web/live/live_state.hpp"
#include "web/log_lines.hpp"
#include "web/metrics.hpp"
#include "web/page_clients.hpp"
#include "web/page_messages.hpp"
#include "web/page_requests.hpp"
#include "web/request_worker.hpp"
#include "web/site_files.hpp"
#include "web/status_hook.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::web {
namespace {

namespace topics = dds::topics;

/// Files that the server serves, and its clients.
class LiveSite final : public http::Handler {
public:
  LiveSite(const WebOptions& options, observation::bus::BusWatch& bus, const live::LiveState& state,
           http::Server& server)
      : server_(server),
        state_(state),
        files_(options.map),
        metrics_(security::expiries_beside(options.domain.enclave_folder)),
        hello_{.version = options.version,
               .allows_changes = options.allows_changes,
               .domain_id = bus.participant().domain_id(),
               .title = "sonopose"},
        pages_([this](std::vector<http::ClientId> clients, std::string text, http::Loss loss) {
          server_.send(std::move(clients), http::shared_text(std::move(text)), true, loss);
        }),
        feed_(bus.participant(), bus.qos(),
              [this](foxglove::Client client, std::string message, bool is_text) {
                const auto loss = is_text ? http::Loss::never : http::Loss::allowed;
                server_.send({client}, http::shared_text(std::move(message)), is_text, loss);
              }),
        worker_(bus.participant(), options.qos_file, options.examine,
                [this](std::string findings) { pages_.broadcast_latest("findings", std::move(findings)); }) {
    metrics_.update({}, clocks::host_now(), clocks::steady_now());
  }

  PageClients& pages() { return pages_; }
  RequestWorker& worker() { return worker_; }
  Metrics& metrics() { return metrics_; }

  void send_time() {
    const threads::Lock lock(feed_mutex_);
    feed_.send_time(clocks::host_now());
  }

  http::Response get(std::string_view path) override {
    const auto answer = metrics_.get(path, clocks::steady_now());
    return answer ? *answer : files_.get(path);
  }

  [[nodiscard]] bool is_public(std::string_view path) const override {
    return path == "/healthz" || files_.is_public(path);
  }

  /// Chooses a protocol. A page of another origin may use only Foxglove's, which changes nothing.
  std::optional<std::string> choose_protocol(std::string_view path, const std::vector<std::string>& offered,
                                             bool is_foreign) override {
    for (const std::string& each : offered) {
      if (each == page_protocol && path == http::websocket_path && !is_foreign) return each;
      const auto& known = foxglove::protocols;
      if (std::find(known.begin(), known.end(), each) != known.end()) return each;
    }
    return {};
  }

  [[nodiscard]] std::string why_refused(const std::vector<std::string>& offered,
                                        bool is_foreign) const override {
    const bool is_page = std::find(offered.begin(), offered.end(), page_protocol) != offered.end();
    return is_page && is_foreign ? "a page of another origin may use only Foxglove's protocol" : "";
  }

  void on_open(http::ClientId client, const std::string& protocol) override {
    if (protocol == page_protocol) {
      return pages_.on_open(client, {text_of(hello_), state_.latest(clocks::host_now())});
    }
    const threads::Lock lock(feed_mutex_);
    feed_.on_open(client);
  }

  void on_message(http::ClientId client, bool is_text, std::string_view message) override {
    if (pages_.has(client)) return on_page_message(client, message);
    const threads::Lock lock(feed_mutex_);
    feed_.on_message(client, is_text, message);
  }

  void on_close(http::ClientId client) override {
    pages_.on_close(client);
    const threads::Lock lock(feed_mutex_);
    feed_.on_close(client);
  }

  void on_dropped(http::ClientId client, std::uint64_t total) override {
    if (pages_.has(client)) return send(client, dropped_text(total));
    const threads::Lock lock(feed_mutex_);
    feed_.on_dropped(client, total);
  }

private:
  void send(http::ClientId client, std::string text) {
    server_.send({client}, http::shared_text(std::move(text)), true, http::Loss::never);
  }

  void on_page_message(http::ClientId client, std::string_view message) {
    PageRequest request = parse_page_request(message);
    if (const auto* const refused = std::get_if<RefusedRequest>(&request)) {
      send(client, text_of(Reply{.id = refused->id, .reason = refused->reason}));
    } else if (const auto* const examination = std::get_if<ExamineRequest>(&request)) {
      worker_.examine(*examination);
    } else if (auto& change = std::get<ChangeRequest>(request); !hello_.allows_changes) {
      send(client, text_of(Reply{.id = change.id, .reason = "start sonopose-web with --allow-changes"}));
    } else {
      worker_.change(std::move(change), [this, client](const Reply& reply) { send(client, text_of(reply)); });
    }
  }

  http::Server& server_;
  const live::LiveState& state_;
  SiteFiles files_;
  Metrics metrics_;
  Hello hello_;
  PageClients pages_;
  threads::Mutex feed_mutex_;
  foxglove::TopicFeed feed_ SONOPOSE_GUARDED_BY(feed_mutex_);
  RequestWorker worker_;
};

/// The latched topics that the pages show.
class LatchedTopics {
public:
  LatchedTopics(const observation::bus::BusWatch& bus, std::size_t max_beacons, PageClients& pages)
      : settings_admission_({}, max_beacons + 1),
        settings_(topics::make_reader(bus.participant(), bus.qos(), topics::settings, nullptr,
                                      topics::Delivery::live, &settings_admission_)),
        stationary_(topics::make_reader(bus.participant(), bus.qos(), topics::stationary_beacon, nullptr,
                                        topics::Delivery::live, &stationary_admission_)),
        pages_(pages) {}

  void poll() {
    dds::ext::try_take_each(
        settings_,
        [&](const sonopose_EffectiveSettings& sample, const dds::sub::SampleInfo& info) {
          pages_.broadcast_latest(name_of(sample.address), settings_text(dds::topics::from_idl(sample)));
          if (!dds::ext::is_alive(info)) forget_settings(sample.address);
        },
        [&](const sonopose_EffectiveSettings& key, const dds::sub::SampleInfo& info) {
          if (!dds::ext::is_alive(info)) forget_settings(key.address);
        });
    bool has_changed = false;
    dds::ext::try_take_each(
        stationary_,
        [&](const sonopose_StationaryBeacon& sample, const dds::sub::SampleInfo& info) {
          const StationaryBeacon beacon = dds::topics::from_idl(sample);
          has_changed = true;
          if (beacon.position_world_m) {
            positions_world_m_[beacon.address] = *beacon.position_world_m;
          } else {
            positions_world_m_.erase(beacon.address);
          }
          if (!dds::ext::is_alive(info)) forget_stationary(sample.address);
        },
        [&](const sonopose_StationaryBeacon& key, const dds::sub::SampleInfo& info) {
          if (!dds::ext::is_alive(info)) has_changed = forget_stationary(key.address) || has_changed;
        });
    if (has_changed) pages_.broadcast_latest("stationary", stationary_text(positions_world_m_));
  }

private:
  static std::string name_of(BeaconAddress address) { return fmt::format("settings {}", address); }

  void forget_settings(BeaconAddress address) {
    pages_.forget(name_of(address));
    settings_admission_.forget(address);
  }

  /// Forgets a stationary beacon. Returns true if it was known.
  bool forget_stationary(BeaconAddress address) {
    stationary_admission_.forget(address);
    return positions_world_m_.erase(address) > 0;
  }

  presence::BeaconAdmission settings_admission_;  ///< includes settings for all beacons
  presence::BeaconAdmission stationary_admission_{{}, presence::BeaconAdmission::default_max_beacons};
  dds::sub::DataReader<sonopose_EffectiveSettings> settings_;
  dds::sub::DataReader<sonopose_StationaryBeacon> stationary_;
  PageClients& pages_;
  std::map<BeaconAddress, Vector3d> positions_world_m_;
};

/// Sends the pages their content at its rates.
class Broadcast {
public:
  Broadcast(observation::bus::BusWatch& bus, const WebOptions& options, live::LiveState& state,
            LiveSite& site)
      : bus_(bus),
        state_(state),
        site_(site),
        hook_(options.on_status),
        latched_(bus, options.max_beacons, site.pages()),
        log_lines_(bus.participant(), bus.qos()) {}

  /// Sends new samples. Call it 25 times a second.
  void send_frame() {
    const SteadyTime now = clocks::steady_now();
    show(log_lines_.take());
    for (const observation::PoseSilence& change : bus_.poll()) {
      silence_log_.on({.address = change.address,
                       .kind = transitions::Kind::poses_silent,
                       .begins = change.silent,
                       .lasted_s = change.lasted_s},
                      now);
    }
    latched_.poll();
    if (site_.pages().empty()) return;
    if (std::string frame = state_.take_frame(clocks::host_now()); !frame.empty()) {
      site_.pages().broadcast(std::move(frame), http::Loss::allowed);
    }
  }

  /// Sends statuses. Call it once a second.
  void send_second() {
    const observation::bus::BusSnapshot snapshot = bus_.take_snapshot();
    site_.metrics().update(snapshot.beacons, clocks::host_now(), clocks::steady_now());
    hook_.update(snapshot, clocks::steady_now());
    silence_log_.update(clocks::steady_now());
    report_left_out();
    if (const auto text = log_lines_.refusals()) logging::warning(*text);
    for (const observation::BeaconView& view : snapshot.gone) {
      state_.forget(view.address);
      silence_log_.forget(view.address);
      site_.pages().broadcast(gone_text(view.address), http::Loss::never);
    }
    site_.worker().report_progress(
        [this](double share) { site_.pages().broadcast(examining_text(share), http::Loss::allowed); });
    site_.send_time();
    if (site_.pages().empty()) return;
    site_.pages().broadcast(
        status_text(observation::bus::json_of(snapshot.beacons, snapshot.warnings, clocks::host_now())),
        http::Loss::allowed);
  }

private:
  /// Shows the latest lines, as far as the limit of this second permits.
  void show(const std::vector<LogLines::Received>& lines) {
    const std::size_t max_lines = max_lines_per_second - lines_in_second_;
    const std::size_t first = lines.size() - std::min(lines.size(), max_lines);
    lines_in_second_ += lines.size() - first;
    lines_left_out_ += first;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto& [line, missing] = lines[i];
      if (i < first) {
        lines_left_out_ += missing;
      } else {
        site_.pages().broadcast_event(event_text(line, missing));
      }
    }
  }

  /// Reports omitted lines, which are bounded because every page receives all.
  void report_left_out() {
    lines_in_second_ = 0;
    const std::uint64_t count = std::exchange(lines_left_out_, 0);
    if (count == 0) return;
    const std::string text = fmt::format("{} left out: too many at a time",
                                         text::count_text(count, "log line was", "log lines were"));
    site_.pages().broadcast_event(event_text(clocks::host_now(), "warning", text));
  }

  static constexpr std::size_t max_lines_per_second = 500;

  observation::bus::BusWatch& bus_;
  live::LiveState& state_;
  LiveSite& site_;
  StatusHook hook_;
  LatchedTopics latched_;
  LogLines log_lines_;
  std::size_t lines_in_second_ = 0;
  std::uint64_t lines_left_out_ = 0;  ///< omitted in this second
  /// Silences of poses, which no fusion can log.
  transitions::TransitionLog silence_log_{[this](const transitions::LogText& line) {
    site_.pages().broadcast_event(event_text(clocks::host_now(), live::word_of(line.level), line.text));
  }};
};

}  // namespace

void serve(const WebOptions& options, const http::OnReady& on_ready, const process::StopSignal& stop) {
  constexpr TimeNs frame_period_ns = 40'000'000;
  constexpr int frames_per_second = 25;
  live::LiveState state;
  observation::bus::BusWatch bus({.domain = options.domain,
                                  .qos_file = options.qos_file,
                                  .max_beacons = options.max_beacons,
                                  .has_reports = true},
                                 &state);
  http::Server server(options.server);
  LiveSite site(options, bus, state, server);
  const http::Serving serving(server, site);
  on_ready(server.urls());
  process::report_ready();
  Broadcast broadcast(bus, options, state, site);
  SteadyTime next = clocks::steady_now() + frame_period_ns;
  for (int frame = 1; !stop.wait_until(next); ++frame) {
    process::report_progress(clocks::steady_now());
    broadcast.send_frame();
    if (frame % frames_per_second == 0) broadcast.send_second();
    next = std::max(next + frame_period_ns, clocks::steady_now());  // missed frames are skipped
  }
}

}  // namespace sonopose::web
