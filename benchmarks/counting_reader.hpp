#pragma once
// A reader that calls a function with each sample of a topic.

#include <sonopose/dds/topics/topics.hpp>

#include <utility>

namespace sonopose::benchmarks {

template <class T, class On>
class CountingReader final : public dds::DataReaderListener<T> {
public:
  CountingReader(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                 const dds::topics::Entry<T>& entry, On on)
      : on_(std::move(on)), reader_(dds::topics::make_reader(participant, qos, entry, this)) {}

  void on_data_available(dds::DataReader<T>& reader) noexcept override {
    reader.try_take_each([this](const T& sample, const dds::SampleInfo&) { on_(sample); });
  }

private:
  On on_;
  dds::DataReader<T> reader_;
};

}  // namespace sonopose::benchmarks
