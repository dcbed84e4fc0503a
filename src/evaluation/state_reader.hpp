#pragma once
/// \file
/// Reads a JSON object strictly: every field exactly once and of the correct type, and no unknown field.

#include "evaluation/state_file.hpp"
#include <sonopose/estimation/documented/state.hpp>

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace sonopose::evaluation {

/// estimation::documented::InitPhase in words, in its order.
inline constexpr std::array<std::string_view, 3> track_names{"none", "position", "held"};

/// Every member function throws a StateFileError that names the file and the field.
class StateReader {
public:
  /// `place` is the file and the path of fields to this object.
  StateReader(nlohmann::json object, std::string place);
  static StateReader parsed(std::string_view text, const std::string& name);

  std::string text(const char* name);
  std::uint64_t count(const char* name);
  std::uint32_t count32(const char* name);
  StateReader object(const char* name);

  void read(const char* name, double& value);
  void read(const char* name, bool& value);
  void read(const char* name, int& value);  ///< a count or index: not negative
  void read(const char* name, TimeNs& value);
  void read(const char* name, estimation::documented::InitPhase& value);
  void read(const char* name, Vector3d& value);
  void read(const char* name, Quaterniond& q);  ///< a unit quaternion
  void read(const char* name, Eigen::Matrix3d& value);
  void read(const char* name, attitude::AnyFilter& filter);
  void read(const char* name, estimation::documented::InertialHistory& history);
  /// Each call reads the next element of the array.
  void read(const char* name, estimation::documented::PastFix& fix);

  /// Throws if an unread field is left.
  void finish() const;

  [[noreturn]] void fail(const std::string& name, const std::string& what) const;

private:
  nlohmann::json take(const char* name);
  nlohmann::json take_array(const char* name);
  template <std::size_t Count>
  std::array<double, Count> take_numbers(const char* name, const char* wanted);

  nlohmann::json object_;
  std::string place_;
  std::map<std::string, std::size_t, std::less<>>
      next_element_;  ///< of arrays that are read element by element
};

}  // namespace sonopose::evaluation
