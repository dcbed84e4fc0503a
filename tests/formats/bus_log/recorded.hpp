#pragma once
/// \file
/// Recordings of the bus made without a bus.

#include "mcap/file_sink.hpp"
#include "mcap/writer.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <bit>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

namespace sonopose::test {

/// The schema of all native topics.
inline const std::string& idl_text() {
  static const std::string text = read_text(std::filesystem::path(SONOPOSE_SOURCE_DIR) / "idl/sonopose.idl");
  return text;
}

/// Writes samples in the format of sonopose-record.
class BusRecording {
public:
  explicit BusRecording(const std::filesystem::path& file, std::endian byte_order = std::endian::little,
                        mcap::WriterOptions options = {}, std::string schema = idl_text())
      : sink_(file),
        writer_(sink_, std::move(options)),
        byte_order_(byte_order),
        schema_(std::move(schema)) {}

  template <class T>
  void write(const dds::topics::Entry<T>& topic, const T& sample, std::uint64_t log_time_ns) {
    const std::string type = dds::TopicTraits<T>::descriptor().m_typename;
    const auto schema = writer_.add_schema(type, "omgidl", schema_);
    const auto channel = writer_.add_channel(schema, topic.name, "cdr");
    const auto cdr = dds::write_cdr(sample, byte_order_);
    writer_.write({channel, ++sequences_[channel], log_time_ns, log_time_ns, cdr});
  }

  void write(const Event& event, std::uint64_t log_time_ns) {
    if (const auto* imu = std::get_if<ImuSample>(&event)) {
      write(dds::topics::imu, dds::topics::to_idl(*imu), log_time_ns);
    } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      write(dds::topics::fix, dds::topics::to_idl(*fix), log_time_ns);
    } else {
      write(dds::topics::heading, dds::topics::to_idl(std::get<PairHeading>(event)), log_time_ns);
    }
  }

  void close() { writer_.close(); }
  [[nodiscard]] mcap::Writer& writer() { return writer_; }

private:
  mcap::FileSink sink_;
  mcap::Writer writer_;
  std::endian byte_order_;
  std::string schema_;
  std::map<std::uint16_t, std::uint32_t> sequences_;
};

}  // namespace sonopose::test
