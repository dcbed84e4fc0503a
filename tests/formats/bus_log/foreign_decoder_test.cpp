/// Third-party decoders read the recordings.

#include "bus_log/filled.hpp"
#include "bus_log/foreign_lines.hpp"
#include "bus_log/recorded.hpp"

#include <catch2/catch.hpp>

#include <iostream>
#include <tuple>

namespace sonopose::foreign_decoder_test {

using namespace sonopose::test;
using Path = std::filesystem::path;

/// Records one sample of each topic, with a unique value in each field.
void record_all_topics(const Path& file, std::endian byte_order, mcap::Compression compression) {
  BusRecording recording(file, byte_order, {.compression = compression});
  FilledFields fields;
  std::uint64_t time_ns = 1'700'000'000'000'000'000;
  const auto record = [&]<class T>(const dds::topics::Entry<T>& topic) {
    T sample{};
    fields.fill(sample);
    recording.write(topic, sample, ++time_ns);
  };
  std::apply([&](const auto&... topics) { (record(topics), ...); }, dds::topics::all);
  const auto settings = dds::topics::to_idl(
      EffectiveSettings{.address = 7,
                        .time_ns = 5,
                        .from_sequence = 3,
                        .values = {{"documented.trust.sigma_m", "0.1"}, {"fusion.engine", ""}}});
  recording.write(dds::topics::settings, settings.sample(), ++time_ns);
}

SCENARIO("decoders that are not ours read every field of every topic") {
  if (!has_foreign_decoders()) {
    std::cout << no_foreign_decoders;
    return;
  }
  const bool has_decompressors = has_foreign_decompressors();
  const TemporaryFolder folder;
  for (const auto byte_order : {std::endian::little, std::endian::big}) {
    for (const auto compression :
         {mcap::Compression::none, mcap::Compression::lz4, mcap::Compression::zstd}) {
      if (compression != mcap::Compression::none && !has_decompressors) continue;
      CAPTURE(static_cast<int>(byte_order), mcap::name_of(compression));
      const Path file = folder / "all.mcap";
      std::filesystem::remove(file);
      record_all_topics(file, byte_order, compression);
      CHECK(check_foreign_lines(file) == std::tuple_size_v<decltype(dds::topics::all)> + 1);
    }
  }
}

}  // namespace sonopose::foreign_decoder_test
