#pragma once
// The pictures of sonopose-replay: a plot, a page, both or none.

#include "page/run_page.hpp"
#include "plots/plot.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::apps {

class Pictures {
public:
  /// Throws what Plot and RunPage throw. `log` must outlive it.
  Pictures(const std::optional<std::filesystem::path>& plot, const std::optional<std::filesystem::path>& html,
           const std::string& title, const recording::SensorLog& log) {
    if (plot) plot_.emplace(*plot, title, log);
    if (html) page_.emplace(*html, title, log);
  }

  /// Where the poses and reports of another run go.
  std::vector<plots::RunCurves*> add_run(const std::string& name, const settings::Settings& settings,
                                         const std::string& engine) {
    std::vector<plots::RunCurves*> curves;
    if (plot_) curves.push_back(&plot_->add_run(name, settings, engine));
    if (page_) curves.push_back(&page_->add_run(name, settings, engine));
    return curves;
  }

  /// Replaces the files.
  void draw() {
    if (plot_) plot_->draw();
    if (page_) page_->write();
  }

private:
  std::optional<plots::Plot> plot_;
  std::optional<page::RunPage> page_;
};

}  // namespace sonopose::apps
