#include "web/recording_node.hpp"

#include "bus_log/recording_files.hpp"
#include "logging/log.hpp"
#include "web/page_messages.hpp"
#include "web/recording/recording_json.hpp"
#include "web/site_files.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

namespace sonopose::web {
namespace {

class RecordingSite final : public http::Handler {
public:
  RecordingSite(const RecordingOptions& options, http::Server& server)
      : server_(server),
        files_(options.map),
        hello_{.version = options.version,
               .is_recording = true,
               .allows_changes = false,
               .domain_id = {},
               .title = bus_log::name_of(options.recording)} {
    files_.add("/recording.json", "application/json",
               recording::recording_json(options.recording, options.beacon));
  }

  http::Response get(std::string_view path) override { return files_.get(path); }

  [[nodiscard]] bool is_public(std::string_view path) const override { return files_.is_public(path); }

  std::optional<std::string> choose_protocol(std::string_view path, const std::vector<std::string>& offered,
                                             bool is_foreign) override {
    const bool is_page = path == http::websocket_path && !is_foreign &&
                         std::find(offered.begin(), offered.end(), page_protocol) != offered.end();
    return is_page ? std::optional<std::string>(page_protocol) : std::nullopt;
  }

  [[nodiscard]] std::string why_refused(const std::vector<std::string>&, bool) const override {
    return "a recording is only for the page of this server; open an MCAP recording in Foxglove itself";
  }

  void on_open(http::ClientId client, const std::string&) override {
    server_.send({client}, http::shared_text(text_of(hello_)), true, http::Loss::never);
  }
  void on_message(http::ClientId, bool, std::string_view) override {}
  void on_close(http::ClientId) override {}
  void on_dropped(http::ClientId, std::uint64_t) override {}

private:
  http::Server& server_;
  SiteFiles files_;
  Hello hello_;
};

}  // namespace

void serve_recording(const RecordingOptions& options, const http::OnReady& on_ready,
                     process::StopSignal& stop) {
  http::Server server(options.server);
  logging::info("reading " + bus_log::name_of(options.recording));
  RecordingSite site(options, server);
  stop.listen_to_signals();  // before, a signal ends the process immediately
  const http::Serving serving(server, site);
  on_ready(server.urls());
  stop.wait_until(SteadyTime::max());
}

}  // namespace sonopose::web
