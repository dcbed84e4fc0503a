#include "files/error.hpp"
#include "files/random_access_file.hpp"
#include "ros2/bag/storage.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <string_view>
#include <system_error>
#ifdef SONOPOSE_HAS_SQLITE
#include <sqlite3.h>
#endif

namespace sonopose::ros2::bag {
namespace {

namespace fs = std::filesystem;

#ifdef SONOPOSE_HAS_SQLITE

/// Path as a URI. A file without a log of changes is opened as one that nobody changes: SQLite then writes
/// nothing beside it, and reads it in a folder that cannot be written.
std::string uri_of(const fs::path& file) {
  std::string uri = "file:";
  for (const char each : fs::absolute(file).string()) {
    const bool is_special = each == '?' || each == '#' || each == '%';
    uri += is_special ? fmt::format("%{:02X}", static_cast<int>(each)) : std::string(1, each);
  }
  std::error_code unknown;
  return uri + (fs::exists(file.string() + "-wal", unknown) ? "?mode=ro" : "?mode=ro&immutable=1");
}

/// A database that is only read.
class Database {
public:
  explicit Database(const fs::path& file) : name_{file.string()} {
    sqlite3* opened = nullptr;
    const int result =
        sqlite3_open_v2(uri_of(file).c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(opened);
    if (result != SQLITE_OK) fail();
    // A foreign file may define views and triggers.
    sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  }

  [[noreturn]] void fail() const {
    throw files::IoError(fmt::format("{}: {}", name_, sqlite3_errmsg(database_.get())));
  }

  /// Calls `use(statement)` for each row until it returns false. Returns false if it did.
  template <class Use>
  bool for_each(const std::string& sql, const Use& use) const {
    sqlite3_stmt* prepared = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &prepared, nullptr) != SQLITE_OK) fail();
    const std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> statement(prepared, sqlite3_finalize);
    int result = SQLITE_ROW;
    while ((result = sqlite3_step(prepared)) == SQLITE_ROW) {
      if (!use(prepared)) return false;
    }
    if (result != SQLITE_DONE) fail();
    return true;
  }

private:
  std::string name_;
  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> database_{nullptr, sqlite3_close};
};

std::string text_at(sqlite3_stmt* row, int column) {
  const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
  return text == nullptr ? "" : text;
}

class SqliteStorage final : public Storage {
public:
  explicit SqliteStorage(const std::vector<fs::path>& files)
      : name_{text::first_of(files.front().string(), files.size())} {
    for (const fs::path& file : files) {
      File& opened = files_.emplace_back(file);
      const Database& database = opened.database;
      std::map<std::int64_t, std::size_t>& topics = opened.topics_by_id;
      std::uint64_t without_topic = 0;
      database.for_each("SELECT id, name, type, serialization_format FROM topics", [&](sqlite3_stmt* row) {
        topics[sqlite3_column_int64(row, 0)] = topic(text_at(row, 1), text_at(row, 2), text_at(row, 3));
        return true;
      });
      const std::string sql = "SELECT topic_id, count(*), min(timestamp) FROM messages GROUP BY topic_id";
      database.for_each(sql, [&](sqlite3_stmt* row) {
        const auto found = topics.find(sqlite3_column_int64(row, 0));
        const auto count = static_cast<std::uint64_t>(sqlite3_column_int64(row, 1));
        (found != topics.end() ? topics_[found->second].messages : without_topic) += count;
        opened.first_ns = std::min<std::int64_t>(opened.first_ns, sqlite3_column_int64(row, 2));
        return true;
      });
      if (without_topic == 0) continue;
      damages_.push_back(fmt::format("{}: {} not read: the table of topics lacks theirs", file.string(),
                                     text::count_text(without_topic, "message")));
    }
    std::ranges::stable_sort(files_, {}, &File::first_ns);  // names may not tell the order
  }

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const std::vector<BagTopic>& topics() const override { return topics_; }
  [[nodiscard]] std::vector<std::string> damages() const override { return damages_; }

  void for_each(const std::set<std::size_t>& topics,
                const std::function<bool(const BagMessage&)>& use) const override {
    for (const File& file : files_) {
      std::vector<std::int64_t> ids;
      for (const auto& [id, topic] : file.topics_by_id) {
        if (topics.contains(topic)) ids.push_back(id);
      }
      const auto use_row = [&](sqlite3_stmt* row) {
        const auto* const data = static_cast<const std::byte*>(sqlite3_column_blob(row, 2));
        const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, 2));
        const auto received_ns = std::max(sqlite3_column_int64(row, 1), sqlite3_int64{0});
        return use({.topic = file.topics_by_id.at(sqlite3_column_int64(row, 0)),
                    .received_ns = static_cast<std::uint64_t>(received_ns),
                    .data = {data, data == nullptr ? 0 : size}});
      };
      const std::string sql = fmt::format(
          "SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({}) ORDER BY timestamp, id",
          fmt::join(ids, ","));
      if (!file.database.for_each(sql, use_row)) return;
    }
  }

private:
  struct File {
    explicit File(const fs::path& path) : database{path} {}

    Database database;
    std::map<std::int64_t, std::size_t> topics_by_id{};
    std::int64_t first_ns = std::numeric_limits<std::int64_t>::max();  ///< time of the first message
  };

  /// Index of a topic, which other files may have too.
  std::size_t topic(std::string name, std::string type, std::string encoding) {
    const auto known = std::ranges::find_if(
        topics_, [&](const BagTopic& each) { return each.name == name && each.type == type; });
    const auto index = static_cast<std::size_t>(known - topics_.begin());
    if (known == topics_.end()) {
      topics_.push_back({.name = std::move(name), .type = std::move(type), .encoding = std::move(encoding)});
    }
    return index;
  }

  std::string name_;
  std::vector<File> files_;
  std::vector<std::string> damages_;
  std::vector<BagTopic> topics_;
};

#endif

}  // namespace

bool is_sqlite(const fs::path& file) {
  constexpr std::string_view magic{"SQLite format 3\0", 16};
  std::error_code unknown;
  if (!fs::is_regular_file(file, unknown)) return false;
  const files::RandomAccessFile opened(file);
  std::array<char, magic.size()> begin{};
  if (opened.size() < begin.size()) return false;
  opened.read(0, std::as_writable_bytes(std::span(begin)));
  return std::string_view(begin.data(), begin.size()) == magic;
}

std::unique_ptr<Storage> sqlite_storage(const std::vector<fs::path>& files) {
#ifdef SONOPOSE_HAS_SQLITE
  return std::make_unique<SqliteStorage>(files);
#else
  throw files::IoError(files.front().string() +
                       ": is in SQLite, which this program was built without: build it with libsqlite3-dev, "
                       "or convert the recording to MCAP");
#endif
}

}  // namespace sonopose::ros2::bag
