#pragma once
// A reader that calls a function with each sample of a topic.

#include <sonopose/dds/topics/topics.hpp>

#include <utility>

namespace sonopose::benchmarks {

template <class T, class On>
class CountingReader final : public dds::sub::NoOpDataReaderListener<T> {
public:
  CountingReader(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                 const dds::topics::Entry<T>& entry, On on)
      : on_(std::move(on)), reader_(dds::topics::make_reader(participant, qos, entry, this)) {}

  void on_data_available(dds::sub::DataReader<T>& reader) noexcept override {
    dds::ext::try_take_each(reader, [this](const T& sample, const dds::sub::SampleInfo&) { on_(sample); });
  }

private:
  On on_;
  dds::sub::DataReader<T> reader_;
};

}  // namespace sonopose::benchmarks
