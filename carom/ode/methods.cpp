#include "carom/ode/methods.h"

namespace carom::ode {

std::string_view to_string(Method method) { return method_names[std::size_t(method)]; }

std::optional<Method> method_from_name(std::string_view name) {
  for (std::size_t i = 0; i < method_names.size(); ++i)
    if (method_names[i] == name) return Method(i);
  return std::nullopt;
}

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::done:
      return "succeeded";
    case Outcome::not_partitioned:
      return "needs a state of positions and velocities";
    case Outcome::no_convergence:
      return "did not solve its implicit equation: the step is too long";
    case Outcome::not_finite:
      return "met a derivative or a state that is not finite";
    case Outcome::step_too_small:
      return "would need steps below the smallest one allowed";
    case Outcome::too_many_steps:
      return "used up the number of steps allowed";
    case Outcome::bad_argument:
      return "was given a step, tolerance or workspace that cannot be used";
  }
  return "";
}

int order(Method method) {
  switch (method) {
    case Method::euler:
    case Method::semi_implicit_euler:
      return 1;
    case Method::midpoint:
    case Method::heun:
    case Method::velocity_verlet:
    case Method::implicit_midpoint:
      return 2;
    case Method::rk4:
      return 4;
    case Method::dormand_prince:
      return 5;
  }
  return 0;
}

}  // namespace carom::ode
