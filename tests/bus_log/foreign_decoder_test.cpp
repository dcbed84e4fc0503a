/// Recordings are read by decoders that are not ours: @mcap/core and @foxglove/omgidl-serialization.
/// NODE_PATH says where they are.

#include "bus_log/filled.hpp"
#include "bus_log/messages.hpp"
#include "bus_log/recorded.hpp"
#include "support/process.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <iostream>
#include <sstream>
#include <tuple>

namespace foreign_decoder_test {

using namespace sonopose;
using namespace sonopose::test;
using Json = nlohmann::json;
using Path = std::filesystem::path;

const Path script = Path(SONOPOSE_SOURCE_DIR) / "tests/interop/mcap_lines.cjs";

bool has_packages(const std::string& packages) {
  try {
    return run("/usr/bin/env", {"node", "-e", packages}).code == 0;
  } catch (const std::system_error&) {
    return false;
  }
}

/// One sample of each topic, each field with a value of its own.
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
  const auto settings =
      dds::topics::to_idl(EffectiveSettings{.address = 7,
                                            .time_ns = 5,
                                            .from_sequence = 3,
                                            .values = {{"trust.sigma_m", "0.1"}, {"fusion.engine", ""}}});
  recording.write(dds::topics::settings, settings.sample(), ++time_ns);
}

std::vector<std::string> our_lines(const Path& file) {
  const mcap::Reader reader(file);
  bus_log::ChosenMessages messages(reader, {});
  std::vector<std::string> lines;
  while (const auto chosen = messages.next())
    lines.push_back(bus_log::json_of(*chosen->channel, chosen->message));
  return lines;
}

/// A float of the IDL is a number with more digits in JavaScript.
bool same(const Json& a, const Json& b) {
  if (a.is_number_float() || b.is_number_float()) {
    const double difference = std::abs(a.get<double>() - b.get<double>());
    return difference <= 1e-7 * std::abs(a.get<double>());
  }
  if (a.is_structured()) {
    if (a.size() != b.size() || a.type() != b.type()) return false;
    for (const auto& item : a.items()) {
      if (a.is_object() && !b.contains(item.key())) return false;
      if (!same(item.value(), a.is_object() ? b.at(item.key()) : b.at(std::stoul(item.key())))) return false;
    }
    return true;
  }
  return a == b;
}

SCENARIO("decoders that are not ours read every field of every topic") {
  if (!has_packages("require('@mcap/core'); require('@foxglove/omgidl-parser'); "
                    "require('@foxglove/omgidl-serialization')")) {
    std::cout
        << "skipped: no node with @mcap/core, @foxglove/omgidl-parser and @foxglove/omgidl-serialization\n";
    return;
  }
  const bool has_decompressors = has_packages("require('@mcap/support')");
  const TemporaryFolder folder;
  for (const auto byte_order : {std::endian::little, std::endian::big}) {
    for (const auto compression :
         {mcap::Compression::none, mcap::Compression::lz4, mcap::Compression::zstd}) {
      if (compression != mcap::Compression::none && !has_decompressors) continue;
      CAPTURE(static_cast<int>(byte_order), mcap::name_of(compression));
      const Path file = folder / "all.mcap";
      std::filesystem::remove(file);
      record_all_topics(file, byte_order, compression);
      const auto ours = our_lines(file);
      REQUIRE(ours.size() == std::tuple_size_v<decltype(dds::topics::all)> + 1);
      const Result theirs = run("/usr/bin/env", {"node", script.string(), file.string()});
      CAPTURE(theirs.error);
      REQUIRE(theirs.code == 0);
      std::istringstream lines(theirs.output);
      std::string line;
      for (const std::string& our_line : ours) {
        REQUIRE(std::getline(lines, line));
        CAPTURE(our_line, line);
        CHECK(same(Json::parse(our_line), Json::parse(line)));
      }
      CHECK_FALSE(std::getline(lines, line));
    }
  }
}

}  // namespace foreign_decoder_test
