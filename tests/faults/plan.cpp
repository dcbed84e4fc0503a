#include "faults/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <random>
#include <string_view>

namespace sonopose::faults {
namespace {

/// Random numbers from a seed, identical with every standard library, unlike the standard's distributions.
class Draw {
public:
  explicit Draw(std::uint64_t seed) : engine_(seed) { engine_.discard(8); }

  std::uint64_t below(std::uint64_t count) { return engine_() % count; }
  bool with_probability(double share) { return static_cast<double>(below(1000)) < 1000.0 * share; }
  TimeNs between_ms(std::uint64_t least, std::uint64_t most) {
    return static_cast<TimeNs>(least + below(most - least + 1)) * 1'000'000;
  }
  template <class T>
  T one_of(const std::vector<T>& values) {
    return values[below(values.size())];
  }

private:
  std::mt19937_64 engine_;
};

bool is_of_line(Fault fault) {
  return fault >= Fault::delay;
}

std::vector<Fault> possible_faults(const Plan& plan, bool clock_steps) {
  // Kills and stops are the main purpose of standby, so they are twice as likely.
  std::vector<Fault> faults{Fault::kill,      Fault::kill,  Fault::stop,    Fault::stop,
                            Fault::terminate, Fault::delay, Fault::garbage, Fault::few_descriptors};
  faults.push_back(plan.line == Line::serial ? Fault::unplug : Fault::reorder);
  if (clock_steps) faults.push_back(Fault::clock_step);
  return faults;
}

TimeNs drawn_clock_step_ns(Draw& draw) {
  const TimeNs size_ns =
      draw.with_probability(0.5) ? draw.between_ms(100, 900) : draw.between_ms(1500, 20'000);
  return draw.with_probability(0.5) ? size_ns : -size_ns;
}

/// The strongest fusion serves, so it is the most likely target.
Role drawn_target(const Plan& plan, Draw& draw) {
  if (draw.with_probability(0.4)) return Role::first_fusion;
  return all_roles[draw.below(static_cast<std::uint64_t>(plan.fusions) + 1)];
}

Step drawn_step(const Plan& plan, Draw& draw, const std::vector<Fault>& faults) {
  Step step;
  step.fault = draw.one_of(faults);
  if (!is_of_line(step.fault)) step.target = drawn_target(plan, draw);
  switch (step.fault) {
    case Fault::kill:
    case Fault::terminate:
    case Fault::unplug:
      step.for_ns = draw.between_ms(100, 700);
      break;
    case Fault::stop:
      step.for_ns = draw.between_ms(60, 1000);
      break;
    case Fault::clock_step:
      step.amount_ns = drawn_clock_step_ns(draw);
      break;
    case Fault::few_descriptors:
      step.count = 6 + static_cast<std::uint32_t>(draw.below(18));
      break;
    case Fault::delay:
      step.for_ns = draw.between_ms(100, 700);
      step.amount_ns = draw.between_ms(10, 200);
      break;
    case Fault::reorder:
      step.for_ns = draw.between_ms(100, 700);
      step.amount_ns = draw.between_ms(6, 60);
      break;
    case Fault::garbage:
      step.for_ns = draw.between_ms(20, 500);
      step.count = 1 + static_cast<std::uint32_t>(draw.below(300));
      break;
  }
  return step;
}

std::string_view name_of(Fault fault) {
  constexpr std::array<std::string_view, 9> names{"kill",          "terminate",       "stop",
                                                  "step clock of", "few descriptors", "delay",
                                                  "reorder",       "garbage",         "unplug"};
  return names.at(static_cast<std::size_t>(fault));
}

}  // namespace

std::int32_t strength_of(Role role) {
  return role == Role::bridge ? 0 : 100 * (4 - static_cast<std::int32_t>(role));
}

std::optional<Role> role_of(std::int32_t strength) {
  for (const Role role : all_roles) {
    if (role != Role::bridge && strength_of(role) == strength) return role;
  }
  return std::nullopt;
}

Plan draw_plan(std::uint64_t seed, bool clock_steps) {
  Draw draw(seed);
  Plan plan;
  plan.seed = seed;
  plan.line = draw.with_probability(0.5) ? Line::serial : Line::udp;
  plan.fusions = draw.with_probability(0.5) ? 2 : 3;
  if (draw.with_probability(0.4)) plan.disk = draw.with_probability(0.5) ? Disk::full : Disk::slow;
  if (draw.with_probability(0.3)) {
    plan.loss = Loss{all_roles[draw.below(static_cast<std::uint64_t>(plan.fusions) + 1)],
                     5 + static_cast<std::uint32_t>(draw.below(100))};
  }
  auto faults = possible_faults(plan, clock_steps);
  const std::uint64_t count = 3 + draw.below(3);
  std::map<std::pair<bool, Role>, TimeNs> free_at_ns;  // by line and process
  TimeNs next_ns = 100'000'000;                        // leaves an undisturbed time at the start
  while (plan.steps.size() < count) {
    Step step = drawn_step(plan, draw, faults);
    TimeNs& free_ns = free_at_ns[{is_of_line(step.fault), step.target}];
    step.at_ns = std::max(next_ns, free_ns);
    free_ns = step.at_ns + step.for_ns + 100'000'000;
    next_ns = step.at_ns + draw.between_ms(50, 600);
    if (step.fault == Fault::clock_step) std::erase(faults, Fault::clock_step);
    plan.steps.push_back(step);
  }
  std::stable_sort(plan.steps.begin(), plan.steps.end(),
                   [](const Step& a, const Step& b) { return a.at_ns < b.at_ns; });
  return plan;
}

std::optional<Role> stepped_clock(const Plan& plan) {
  for (const Step& step : plan.steps) {
    if (step.fault == Fault::clock_step) return step.target;
  }
  return std::nullopt;
}

std::string text_of(Role role) {
  return role == Role::bridge ? "bridge" : fmt::format("fusion-{}", strength_of(role));
}

std::string text_of(const Step& step) {
  std::string text = fmt::format("{:.2f} s {}", seconds_between(0, step.at_ns), name_of(step.fault));
  if (!is_of_line(step.fault) && step.fault != Fault::few_descriptors) text += " " + text_of(step.target);
  if (step.amount_ns != 0) text += fmt::format(" by {:.3f} s", seconds_between(0, step.amount_ns));
  if (step.count != 0) text += fmt::format(" {}", step.count);
  if (step.for_ns != 0) text += fmt::format(" for {:.2f} s", seconds_between(0, step.for_ns));
  return text;
}

std::string text_of(const Plan& plan) {
  std::string text =
      fmt::format("{}, {} fusions", plan.line == Line::serial ? "serial" : "udp", plan.fusions);
  if (plan.disk != Disk::none) text += plan.disk == Disk::full ? ", full disk" : ", slow disk";
  if (plan.loss) text += fmt::format(", {} loses {} ‰", text_of(plan.loss->role), plan.loss->permille);
  text += ": ";
  for (std::size_t i = 0; i < plan.steps.size(); ++i) text += (i == 0 ? "" : "; ") + text_of(plan.steps[i]);
  return text;
}

}  // namespace sonopose::faults
