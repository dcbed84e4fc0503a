#pragma once
/// \file
/// The messages of a rosbag2 recording, in files of either kind.

#include "mcap/reader.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace sonopose::ros2::bag {

struct BagTopic {
  std::string name;      ///< such as "/imu/data"
  std::string type;      ///< such as "sensor_msgs/msg/Imu"; empty if the file does not say
  std::string encoding;  ///< "cdr"; empty if the file does not say
  std::uint64_t messages = 0;
};

struct BagMessage {
  std::size_t topic = 0;          ///< index in Storage::topics()
  std::uint64_t received_ns = 0;  ///< reception by the recorder, since the Unix epoch
  std::span<const std::byte> data;
};

class Storage {
public:
  virtual ~Storage() = default;

  /// Name of the recording, for messages.
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] virtual const std::vector<BagTopic>& topics() const = 0;
  /// Descriptions of damage; empty for a sound recording.
  [[nodiscard]] virtual std::vector<std::string> damages() const = 0;
  /// Calls `use` with each message of these topics by time of reception, until it returns false. The data are
  /// valid during the call. Throws files::IoError.
  virtual void for_each(const std::set<std::size_t>& topics,
                        const std::function<bool(const BagMessage&)>& use) const = 0;
};

/// The reader must outlive the storage.
std::unique_ptr<Storage> mcap_storage(const mcap::Reader& reader);

/// Returns true for a file that begins like SQLite 3.
bool is_sqlite(const std::filesystem::path& file);

/// Several files follow one another by their first messages. Throws files::IoError, also if the program was
/// built without SQLite.
std::unique_ptr<Storage> sqlite_storage(const std::vector<std::filesystem::path>& files);

}  // namespace sonopose::ros2::bag
