#pragma once
/// \file
/// Answers of the server to a GET: the page's own files, the plotting library, and constant data.

#include "web/http/server.hpp"
#include "web/map_layers.hpp"

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace sonopose::web {

/// The constant answers of the server, read once.
class SiteFiles {
public:
  /// Throws files::IoError if the plotting library is not installed.
  explicit SiteFiles(const MapLayers& layers);

  void add(const std::string& path, const std::string& content_type, std::string text);

  /// True for one of the program's own files, which contain no secrets.
  [[nodiscard]] bool is_public(std::string_view path) const { return public_.contains(path); }

  /// Returns the file with this name; 404 for anything else.
  [[nodiscard]] http::Response get(std::string_view path) const;

private:
  void add_public(const std::string& path, const std::string& content_type, std::string text);

  std::set<std::string, std::less<>> public_;
  std::map<std::string, http::Response, std::less<>> files_;
};

}  // namespace sonopose::web
