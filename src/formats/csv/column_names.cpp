#include "csv/column_names.hpp"

#include <algorithm>

namespace sonopose::csv {

const std::pair<const std::string, std::string>* ColumnNames::find(const std::filesystem::path& file,
                                                                   const std::string& name) const {
  for (const std::string& key : {file.string() + ":" + name, file.filename().string() + ":" + name, name}) {
    if (const auto entry = own_by_given.find(key); entry != own_by_given.end()) return &*entry;
  }
  return nullptr;
}

std::string ColumnNames::option(std::size_t reader, const std::string& column, std::string_view unit) const {
  const std::string& name = columns_by_reader.at(reader).at(column);
  bool is_in_other = false;
  for (std::size_t other = 0; other < file_by_reader.size(); ++other) {
    if (file_by_reader[other] == file_by_reader[reader]) continue;
    is_in_other |= std::ranges::any_of(columns_by_reader[other],
                                       [&name](const auto& entry) { return entry.second == name; });
  }
  std::string text = "--column \"";
  if (is_in_other) text += file_by_reader[reader].filename().string() + ":";
  return text.append(column).append(" [").append(unit).append("]=").append(name) + "\"";
}

}  // namespace sonopose::csv
