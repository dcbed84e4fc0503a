#pragma once
/// \file
/// What the server answers to a GET: the page's own files, the plotting library, and what does not change.

#include "web/http/server.hpp"
#include "web/map_layers.hpp"

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace sonopose::web {

class SiteFiles {
public:
  /// Throws files::IoError if the plotting library is not installed.
  explicit SiteFiles(const MapLayers& layers);

  void add(const std::string& path, const std::string& content_type, std::string text);

  /// Whether it is one of the program's own files, in which nothing is secret.
  [[nodiscard]] bool is_public(std::string_view path) const { return public_.contains(path); }

  /// Only what has a name here is served: 404 for anything else.
  [[nodiscard]] http::Response get(std::string_view path) const;

private:
  void add_public(const std::string& path, const std::string& content_type, std::string text);

  std::set<std::string, std::less<>> public_;
  std::map<std::string, http::Response, std::less<>> files_;
};

}  // namespace sonopose::web
