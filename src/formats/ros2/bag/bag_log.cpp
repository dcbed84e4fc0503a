#include "ros2/bag/bag_log.hpp"

#include "files/error.hpp"
#include "mcap/decompression.hpp"
#include "ros2/bag/truth_input.hpp"
#include "ros2/inputs/aiding_samples.hpp"
#include "ros2/inputs/beacon_inputs.hpp"
#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/static_transforms.hpp>
#include <sonopose/ros2/messages/time.hpp>
#include <sonopose/text/count_text.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <list>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace sonopose::ros2::bag {
namespace {

constexpr std::string_view static_transforms = "/tf_static";
/// The limit of a log folder's times: the difference of any two fits into 64 bits.
constexpr std::uint64_t too_late_ns = std::uint64_t{1} << 62U;

bool is_time(TimeNs time_ns) {
  return time_ns > 0 && static_cast<std::uint64_t>(time_ns) < too_late_ns;
}

class Reading {
public:
  Reading(const Storage& storage, const TopicChoice& choice, std::optional<BeaconAddress> address,
          bool needs_fixes)
      : storage_{storage}, inputs_{find_inputs(storage, choice, address, needs_fixes)} {
    read_.log.address = inputs_.address;
    read_.log.warnings = storage.damages();
    read_.notes = inputs_.notes;
    for (const Inputs::OfInput& input : inputs_.inputs) {
      beacon_.add(input.option);
      monitored_.emplace_back(input.option, choice.map_frame, TimeNs{0}, SteadyTime{});
      input_of_topic_.emplace(input.topic, &monitored_.back());
    }
    for (const Inputs::OfAiding& aiding : inputs_.aidings) {
      monitored_.emplace_back(monitored_as(aiding.option), "", TimeNs{0}, SteadyTime{});
      aidings_of_topic_.emplace(aiding.topic, std::pair(aiding.option, &monitored_.back()));
    }
    const bool has_tags = std::ranges::any_of(inputs_.inputs, [](const Inputs::OfInput& input) {
      return input.option.tag_base_m || !input.option.tag_frame.empty();
    });
    names_.base = without_slash(choice.base_frame);
    names_.map = without_slash(choice.map_frame);
    if (!inputs_.aidings.empty() || inputs_.truth || has_tags) find_mount();
    are_imus_named_ = !choice.imu.empty();
    are_fixes_named_ = !choice.fix.empty();
  }

  BagLog read() {
    std::set<std::size_t> topics;
    for (const auto& [topic, input] : input_of_topic_) topics.insert(topic);
    for (const auto& [topic, aiding] : aidings_of_topic_) topics.insert(topic);
    if (inputs_.truth) topics.insert(*inputs_.truth);
    storage_.for_each(topics, [this](const BagMessage& message) {
      take(message);
      return true;
    });
    beacon_.update(SteadyTime::max(), ready_, lines_);
    add_ready();
    std::ranges::stable_sort(read_.log.truth, {}, &TruthSample::time_ns);
    require_use();
    report(topics);
    return std::move(read_);
  }

private:
  /// Calls `use` with the message as this type, and returns true. Messages that are compressed one by one are
  /// expanded. One that is damaged or of another type is counted.
  template <class T, class Use>
  bool decode(const BagMessage& message, const Use& use) {
    constexpr std::array zstd_magic{std::byte{0x28}, std::byte{0xb5}, std::byte{0x2f}, std::byte{0xfd}};
    constexpr std::size_t max_bytes = 256U << 20U;
    std::span<const std::byte> data = message.data;
    if (data.size() >= zstd_magic.size() && std::ranges::equal(data.first(zstd_magic.size()), zstd_magic)) {
      const auto result = mcap::decompress(mcap::Compression::zstd, data, max_bytes, expanded_);
      if (result != mcap::Decompressed::complete) {
        ++unused_[{message.topic, "compressed by zstd and damaged"}];
        return false;
      }
      data = expanded_;
    }
    const dds::CdrSample<T> sample(data);
    if (sample.get() == nullptr) {
      ++unused_[{message.topic, "no serialized " + text::escaped(storage_.topics()[message.topic].type)}];
      return false;
    }
    use(*sample.get());
    return true;
  }

  std::set<std::size_t> topics_named(std::string_view name, std::string_view type) const {
    std::set<std::size_t> found;
    for (std::size_t i = 0; i < storage_.topics().size(); ++i) {
      const BagTopic& topic = storage_.topics()[i];
      if (topic.name == name && topic.type == type && is_usable(topic)) found.insert(i);
    }
    return found;
  }

  /// Finds the IMU on the base in the recorded transforms.
  void find_mount() {
    std::set<std::size_t> imus;
    for (const Inputs::OfInput& input : inputs_.inputs) {
      if (input.option.kind == Input::Kind::imu) imus.insert(input.topic);
    }
    storage_.for_each(imus, [&](const BagMessage& message) {
      return !decode<Imu>(message, [&](const Imu& imu) { names_.imu = without_slash(imu.header.frame_id); });
    });
    unused_.clear();  // read again
    const auto used = topics_named(static_transforms, "tf2_msgs/msg/TFMessage");
    storage_.for_each(used, [&](const BagMessage& message) {
      decode<TFMessage>(message, [&](const TFMessage& tf) { transforms_.add(tf); });
      return true;
    });
    transform_topics_ = used;
    if (!transforms_.moved().empty()) {
      read_.log.warnings.push_back(fmt::format(
          "{}: {} moves {}: the latest place counts for the whole recording", storage_.name(),
          static_transforms, text::escaped(fmt::format("{}", fmt::join(transforms_.moved(), ", ")))));
    }
    if (const auto found = transforms_.find(names_.base, names_.imu)) {
      mount_ = {found->translation_m, found->rotation};
      return;
    }
    read_.log.warnings.push_back(fmt::format(
        "{}: has no transform from {} to '{}' in {}: velocities, headings, poses, tags and truth are "
        "taken as those of the IMU; --base-frame names another frame",
        storage_.name(), names_.base, text::escaped(names_.imu), static_transforms));
  }

  void take(const BagMessage& message) {
    const auto received_ns = static_cast<TimeNs>(std::min(message.received_ns, too_late_ns - 1));
    const BeaconInputs::Moment moment{received_.next(received_ns).value_or(received_ns), {received_ns}, 0};
    beacon_.update(moment.now, ready_, lines_);
    add_ready();
    if (inputs_.truth == message.topic) take_truth(message, moment.received_ns);
    const auto input = input_of_topic_.find(message.topic);
    if (input != input_of_topic_.end()) take_input(message, moment, *input->second);
    const auto [first, end] = aidings_of_topic_.equal_range(message.topic);
    for (auto aiding = first; aiding != end; ++aiding) take_aiding(message, moment, aiding->second);
  }

  void take_input(const BagMessage& message, const BeaconInputs::Moment& moment, MonitoredInput& input) {
    bool is_valid = false;
    bool is_decoded = false;
    std::string reason = "a value is not finite or a stamp is invalid";
    const auto take_fix = [&](const auto& position) {
      const auto taken = beacon_.on(position, input, moment, frames_, lines_);
      is_valid = taken.is_valid;
      if (!taken.unused.empty()) reason = taken.unused;
      if (!taken.fix) return;
      is_valid = add(*taken.fix);
      if (fix_frame_.empty()) fix_frame_ = without_slash(position.header.frame_id);
      // A recording shows latencies, and so an age, but no stamps after the arrival.
      if (beacon_.older_s(input) < 0) beacon_.check_clocks(input, moment.now, lines_);
    };
    if (input.option.kind == Input::Kind::imu) {
      is_decoded = decode<Imu>(message, [&](const Imu& imu) {
        is_valid = beacon_.on(imu, input, moment, ready_, lines_) && add_ready();
      });
    } else if (input.option.fix_type == FixType::point) {
      is_decoded = decode<PointStamped>(message, take_fix);
    } else {
      is_decoded = decode<PoseWithCovarianceStamped>(message, take_fix);
    }
    if (is_decoded) count(input, message.topic, is_valid, reason);
  }

  /// Counts a message of an input, with the reason if it is not used.
  void count(const MonitoredInput& input, std::size_t topic, bool is_used, const std::string& reason) {
    if (is_used) {
      used_.insert(&input);
    } else {
      ++unused_[{topic, reason}];
    }
  }

  void take_aiding(const BagMessage& message, const BeaconInputs::Moment& moment,
                   const std::pair<AidingInput, MonitoredInput*>& aiding) {
    const auto convert = [&](const auto& measured) {
      const auto samples = samples_of(measured, aiding.first, frames_, beacon_.stamp_at(moment.received_ns));
      const auto measured_ns = samples.measured_ns();
      if (measured_ns && !samples.unused.empty()) aiding.second->monitor.on_unused(samples.unused, lines_);
      bool are_valid = !samples.twist || add(*samples.twist);
      are_valid = (!samples.heading || add(*samples.heading)) && are_valid;
      are_valid = (!samples.fix || add(*samples.fix)) && are_valid;
      const bool is_used = measured_ns && are_valid;
      count(*aiding.second, message.topic, is_used, measured_ns ? "a stamp is invalid" : samples.unused);
      if (!is_used) return;
      if constexpr (requires { measured.header; }) {
        BeaconInputs::notice_stamp(measured.header, *aiding.second, lines_);
      }
      BeaconInputs::note_stamp(*measured_ns, *aiding.second, moment);
      beacon_.check_clocks(*aiding.second, moment.now, lines_);
    };
    switch (aiding.first.type) {
      case AidingInput::Type::odometry:
        decode<Odometry>(message, convert);
        break;
      case AidingInput::Type::twist_with_covariance:
        decode<TwistWithCovarianceStamped>(message, convert);
        break;
      case AidingInput::Type::twist:
        decode<TwistStamped>(message, convert);
        break;
      case AidingInput::Type::joints:
        decode<JointState>(message, convert);
        break;
      case AidingInput::Type::imu:
        decode<Imu>(message, convert);
        break;
      case AidingInput::Type::pose_with_covariance:
        decode<PoseWithCovarianceStamped>(message, convert);
        break;
      case AidingInput::Type::pose:
        decode<PoseStamped>(message, convert);
        break;
      case AidingInput::Type::degrees:
        decode<Float64>(message, convert);
        break;
      case AidingInput::Type::set_pose_service:  // not recorded
        break;
    }
  }

  void take_truth(const BagMessage& message, TimeNs received_ns) {
    const auto convert = [&](const auto& pose) {
      const auto truth = truth_.on(pose, inputs_.address, received_ns);
      if (truth && is_time(truth->time_ns)) {
        read_.log.truth.push_back(*truth);
      } else {
        ++unused_[{message.topic, "a stamp is invalid"}];
      }
    };
    const std::string& type = storage_.topics()[message.topic].type;
    if (type.ends_with("Odometry")) {
      decode<Odometry>(message, convert);
    } else if (type.ends_with("PoseStamped")) {
      decode<PoseStamped>(message, convert);
    } else {
      decode<PoseWithCovarianceStamped>(message, convert);
    }
  }

  /// Returns false for a sample whose time is impossible.
  template <class Sample>
  bool add(Sample sample) {
    if constexpr (requires { sample.emission_time_ns; }) {
      if (!is_time(sample.emission_time_ns)) return false;
    }
    if (!is_time(available_at_ns(sample))) return false;
    sample.sequence = read_.log.events.size() + 1;
    read_.log.events.emplace_back(std::move(sample));
    return true;
  }

  bool add_ready() {
    bool are_valid = true;
    for (const ImuSample& sample : ready_) are_valid = add(sample) && are_valid;
    ready_.clear();
    return are_valid;
  }

  /// Fails for a topic that was chosen by name, and of which no message is used.
  void require_use() const {
    const auto require = [this](std::size_t topic, bool is_used, std::string_view option) {
      if (is_used) return;
      const auto more = [](const auto& a, const auto& b) { return a.second < b.second; };
      const auto is_of_other = [topic](const auto& cause) { return cause.first.first != topic; };
      std::map<std::pair<std::size_t, std::string>, std::uint64_t> causes = unused_;
      std::erase_if(causes, is_of_other);
      std::uint64_t sum = 0;
      for (const auto& [cause, number] : causes) sum += number;
      const auto most = std::ranges::max_element(causes, more);
      throw files::IoError(fmt::format(
          "{}: {} {}: {}", storage_.name(), option, text::escaped(storage_.topics()[topic].name),
          most == causes.end() ? "has no message"
                               : fmt::format("none of its {} is used: {}", text::count_text(sum, "message"),
                                             most->first.second)));
    };
    for (const auto& [topic, input] : input_of_topic_) {
      const bool is_imu = input->option.kind == Input::Kind::imu;
      if (is_imu ? are_imus_named_ : are_fixes_named_)
        require(topic, used_.contains(input), is_imu ? "--imu-in" : "--fix-in");
    }
    for (const auto& [topic, aiding] : aidings_of_topic_) {
      require(topic, used_.contains(aiding.second), option_name(aiding.first.kind));
    }
    if (inputs_.truth) require(*inputs_.truth, !read_.log.truth.empty(), "--truth-in");
  }

  void report(const std::set<std::size_t>& used) {
    for (const InputMonitor::Line& line : lines_) {
      auto& texts = line.level == logging::Level::info ? read_.notes : read_.log.warnings;
      texts.push_back(fmt::format("{}: {}", storage_.name(), line.text()));
    }
    const auto warn = [&](std::uint64_t count, std::string_view noun, const std::string& why) {
      if (count == 0) return;
      read_.log.warnings.push_back(
          fmt::format("{}: {} not used: {}", storage_.name(), text::count_text(count, noun), why));
    };
    for (const auto& [cause, count] : unused_) {
      warn(count, "message",
           fmt::format("of {}, {}", text::escaped(storage_.topics()[cause.first].name), cause.second));
    }
    for (const MonitoredInput& input : monitored_) {
      if (input.unstamped == 0) continue;
      read_.log.warnings.push_back(fmt::format("{}: {} of {} without a stamp", storage_.name(),
                                               text::count_text(input.unstamped, "message"),
                                               text::escaped(input.option.topic)));
    }
    for (const std::string& assumed : truth_.assumptions(fix_frame_)) {
      read_.log.warnings.push_back(fmt::format(
          "{}: {} {}", storage_.name(), text::escaped(storage_.topics()[*inputs_.truth].name), assumed));
    }
    warn(beacon_.dropped(), "sample", "of a gyroscope, without a linear acceleration near it");
    constexpr std::size_t max_listed = 20;
    std::vector<std::string> unused;
    std::size_t more = 0;
    for (std::size_t i = 0; i < storage_.topics().size(); ++i) {
      if (used.contains(i) || transform_topics_.contains(i)) continue;
      if (unused.size() < max_listed)
        unused.push_back(with_type(storage_.topics()[i]));
      else
        ++more;
    }
    if (unused.empty()) return;
    read_.notes.push_back(fmt::format("{}: not used: {}{}", storage_.name(), fmt::join(unused, ", "),
                                      more == 0 ? "" : fmt::format(" and {} more", more)));
  }

  const Storage& storage_;
  Inputs inputs_;
  BeaconInputs beacon_;
  std::list<MonitoredInput> monitored_;  ///< stay in place
  std::map<std::size_t, MonitoredInput*> input_of_topic_;
  std::multimap<std::size_t, std::pair<AidingInput, MonitoredInput*>> aidings_of_topic_;
  std::set<std::size_t> transform_topics_;
  FrameNames names_;
  StaticTransforms transforms_;
  Mount mount_;
  const InputFrames frames_ = input_frames(
      names_, [this](BeaconAddress /*address*/) { return mount_; },
      [this](const auto& in, const auto& frame) { return transforms_.between(in, frame); });
  TruthInput truth_{frames_};
  std::string fix_frame_;  ///< that of the first used fix
  RisingStamp received_;
  std::vector<ImuSample> ready_;
  InputMonitor::Lines lines_;
  bool are_imus_named_ = false;
  bool are_fixes_named_ = false;
  std::set<const MonitoredInput*> used_;  ///< inputs with a message that is used
  std::map<std::pair<std::size_t, std::string>, std::uint64_t> unused_;  ///< messages by topic and reason
  std::vector<std::byte> expanded_;
  BagLog read_;
};

}  // namespace

BagLog read_bag(const Storage& storage, const TopicChoice& choice, std::optional<BeaconAddress> address,
                bool needs_fixes) {
  return Reading(storage, choice, address, needs_fixes).read();
}

}  // namespace sonopose::ros2::bag
