#include "ros2/relay/fixed_frames.hpp"

namespace sonopose::ros2::relay {

FixedFrames::FixedFrames(ros2::Node& node)
    : reader_(node.make_reader<ros2::TFMessage>("/tf_static", "ros2::TfStatic", &listener_)) {}

void FixedFrames::Listener::on_data_available(dds::sub::DataReader<ros2::TFMessage>& reader) noexcept {
  const threads::Lock lock(frames_.mutex_);
  dds::ext::try_take_each(reader, [this](const ros2::TFMessage& message, const dds::sub::SampleInfo&) {
    frames_.mutex_.assert_held();
    frames_.transforms_.add(message);
  });
}

std::optional<ros2::Transform> FixedFrames::find(const std::string& in, const std::string& frame) const {
  const threads::Lock lock(mutex_);
  return transforms_.between(in, frame);
}

}  // namespace sonopose::ros2::relay
