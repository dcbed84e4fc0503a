#include "web/site_files.hpp"

#include "web/assets.hpp"
#include "web/dygraphs.hpp"
#include "web/page_messages.hpp"

#include <utility>

namespace sonopose::web {

SiteFiles::SiteFiles(const MapLayers& layers) {
  for (const Asset& asset : assets()) {
    add_public("/" + std::string(asset.name), std::string(asset.content_type), std::string(asset.text));
  }
  files_["/"] = files_.at("/index.html");
  public_.insert("/");
  add_public("/dygraphs/dygraph.min.js", "text/javascript; charset=utf-8", dygraphs_file("dygraph.min.js"));
  add_public("/dygraphs/dygraph.min.css", "text/css; charset=utf-8", dygraphs_file("dygraph.min.css"));
  add("/settings.json", "application/json", settings_table_json());
  add("/status.json", "application/json", status_table_json());
  add("/map.json", "application/json", json_of(layers));
  if (layers.floor_plan) files_["/floor-plan"] = layers.floor_plan->picture;
}

void SiteFiles::add(const std::string& path, const std::string& content_type, std::string text) {
  files_[path] = {.content_type = content_type, .body = http::shared_text(std::move(text))};
}

void SiteFiles::add_public(const std::string& path, const std::string& content_type, std::string text) {
  add(path, content_type, std::move(text));
  public_.insert(path);
}

http::Response SiteFiles::get(std::string_view path) const {
  const auto found = files_.find(path);
  return found != files_.end() ? found->second : http::text_response(404, "there is no such page\n");
}

}  // namespace sonopose::web
