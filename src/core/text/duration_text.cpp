#include <sonopose/text/duration_text.hpp>
#include <sonopose/text/number_text.hpp>

#include <array>

namespace sonopose::text {

std::string duration_text(double duration_s) {
  struct Unit {
    double length_s;
    const char* name;
  };
  constexpr std::array longer{Unit{365.25 * 86400, " years"}, Unit{86400, " d"}, Unit{3600, " h"},
                              Unit{60, " min"}};
  for (const Unit& unit : longer) {
    if (duration_s >= 2 * unit.length_s) return number_text(duration_s / unit.length_s, 1) + unit.name;
  }
  return number_text(duration_s, 1) + " s";
}

}  // namespace sonopose::text
