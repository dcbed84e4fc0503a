#include "bus_log/copy.hpp"

#include "bus_log/log_times.hpp"
#include "bus_log/recording_files.hpp"
#include "files/error.hpp"
#include "mcap/file_sink.hpp"
#include "mcap/verify.hpp"
#include "mcap/writer.hpp"
#include "recording/part_file.hpp"
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <system_error>

namespace sonopose::bus_log {

namespace {

using Files = std::vector<std::filesystem::path>;

/// The files of each input.
std::vector<Files> inputs_of(const CopyRequest& request) {
  const Files files = recording_files(request.inputs);
  std::vector<Files> inputs;
  if (request.is_one_recording) {
    inputs.push_back(files);
  } else {
    for (const std::filesystem::path& file : files) inputs.push_back(Files{file});
  }
  return inputs;
}

/// An input and its next message.
struct Input {
  Input(const Files& files, const CopyRequest& request, mcap::Selection::Order order)
      : reader{files}, messages{reader, request.choice, request.damaged, order} {
    messages.begin_with_latched();
    if (request.is_one_recording) warn_of_times(reader);
  }

  mcap::Reader reader;
  ChosenMessages messages;
  std::optional<ChosenMessages::Chosen> next{};
  std::map<std::uint16_t, std::uint16_t> channels{};  ///< output channel by input channel
};

class Copy {
public:
  explicit Copy(const CopyRequest& request) : damaged_{request.damaged}, on_progress_{request.on_progress} {
    const std::vector<Files> all = inputs_of(request);
    const auto order = all.size() == 1 ? mcap::Selection::Order::file : mcap::Selection::Order::log_time;
    for (const Files& files : all) {
      Input& input = inputs_.emplace_back(files, request, order);
      const mcap::Contents& contents = input.reader.contents();
      result_.stated += contents.statistics.message_count + contents.lost_messages;
      result_.has_uncounted_loss = result_.has_uncounted_loss || contents.has_uncounted_loss;
      const std::string& profile = input.reader.contents().profile;
      const std::string& first = inputs_.front().reader.contents().profile;
      if (profile != first) {
        throw files::IoError(fmt::format(R"({}: has profile "{}", but {} has "{}"; a file has one profile)",
                                         input.reader.name(), text::escaped(profile),
                                         inputs_.front().reader.name(), text::escaped(first)));
      }
    }
  }

  CopyResult run(mcap::Writer& writer) {
    for (Input& input : inputs_) {
      for (const mcap::Metadata& metadata : metadata_of(input.reader)) {
        writer.write_metadata(metadata);
        ++result_.metadata;
      }
      for (const mcap::Extent& attachment : input.reader.contents().attachments) {
        copy_attachment(input.reader, attachment, writer);
      }
      for (const auto& [id, channel] : input.reader.channels()) {
        if (input.messages.has(channel)) channel_of(input, channel, writer);
      }
      input.next = input.messages.next();
    }
    while (Input* input = earliest()) {
      mcap::Message message = input->next->message;
      message.channel_id = channel_of(*input, *input->next->channel, writer);
      writer.write(message);
      ++result_.messages;
      report_progress();
      input->next = input->messages.next();
    }
    writer.close();
    for (const Input& input : inputs_) {
      const auto& damages = input.reader.damages();
      const auto& skipped = input.messages.skipped();
      for (const auto* const texts : {&damages, &skipped, &input.messages.skipped_before()}) {
        result_.damages.insert(result_.damages.end(), texts->begin(), texts->end());
      }
      // Known damage already explains a wrong checksum of the whole file.
      if (damaged_ != mcap::Selection::Damaged::skip || !damages.empty() || !skipped.empty()) continue;
      const auto sums = mcap::verify(input.reader);
      result_.damages.insert(result_.damages.end(), sums.begin(), sums.end());
    }
    require_messages();
    return std::move(result_);
  }

  [[nodiscard]] const std::string& profile() const { return inputs_.front().reader.contents().profile; }
  [[nodiscard]] const std::string& library() const { return inputs_.front().reader.contents().library; }

private:
  std::vector<mcap::Metadata> metadata_of(const mcap::Reader& reader) {
    const bool is_skipping = damaged_ == mcap::Selection::Damaged::skip;
    return is_skipping ? reader.metadata(result_.damages) : reader.metadata();
  }

  void copy_attachment(const mcap::Reader& reader, const mcap::Extent& attachment, mcap::Writer& writer) {
    try {
      writer.write_attachment(reader.attachment(attachment));
      ++result_.attachments;
    } catch (const mcap::FormatError& error) {
      if (damaged_ != mcap::Selection::Damaged::skip) throw;
      result_.damages.emplace_back(error.what());
    }
  }

  /// Refuses a copy without messages.
  void require_messages() const {
    if (result_.messages > 0) return;
    std::vector<const mcap::Reader*> readers;
    for (const Input& input : inputs_) readers.push_back(&input.reader);
    throw nothing_selected(readers, result_.stated, result_.damages.empty() ? "" : result_.damages.front());
  }

  void report_progress() const {
    constexpr std::uint64_t period = 10'000;
    if (!on_progress_ || result_.messages % period != 0) return;
    on_progress_(static_cast<double>(result_.messages) /
                 static_cast<double>(std::max(result_.stated, result_.messages)));
  }

  Input* earliest() {
    Input* found = nullptr;
    for (Input& input : inputs_) {
      if (!input.next) continue;
      if (found == nullptr || input.next->message.log_time_ns < found->next->message.log_time_ns)
        found = &input;
    }
    return found;
  }

  static std::uint16_t channel_of(Input& input, const mcap::Channel& channel, mcap::Writer& writer) {
    const auto known = input.channels.find(channel.id);
    if (known != input.channels.end()) return known->second;
    std::uint16_t schema_id = 0;
    const auto schema = input.reader.schemas().find(channel.schema_id);
    if (schema != input.reader.schemas().end()) {
      schema_id = writer.add_schema(schema->second.name, schema->second.encoding, schema->second.data);
    }
    const auto id = writer.add_channel(schema_id, channel.topic, channel.message_encoding, channel.metadata);
    input.channels.emplace(channel.id, id);
    return id;
  }

  mcap::Selection::Damaged damaged_;
  const std::function<void(double)>& on_progress_;
  std::deque<Input> inputs_;
  CopyResult result_;
};

/// Throws if an input is the output's temporary file: `run.mcap.part` cannot be repaired to `run.mcap`.
void refuse_own_part(const CopyRequest& request) {
  for (const std::filesystem::path& input : recording_files(request.inputs)) {
    std::error_code error;
    if (!std::filesystem::equivalent(input, recording::part_of(request.output), error)) continue;
    throw files::IoError(input.string() + ": is where " + request.output.string() +
                         " would be written first; choose another --out");
  }
}

}  // namespace

CopyResult copy(const CopyRequest& request) {
  Copy copying(request);
  refuse_own_part(request);
  const recording::PartFile name(request.output);
  mcap::FileSink sink(name.part());
  try {
    mcap::Writer writer(
        sink,
        {.profile = copying.profile(), .library = copying.library(), .compression = request.compression});
    const CopyResult result = copying.run(writer);
    name.commit();
    return result;
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(name.part(), ignored);
    throw;
  }
}

}  // namespace sonopose::bus_log
