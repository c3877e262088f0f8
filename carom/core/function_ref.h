// A reference to something callable: two words, no allocation, no ownership.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace carom::core {

template <class Signature>
class FunctionRef;

/// Refers to a callable that must outlive the reference: for parameters, not for members.
template <class R, class... Arguments>
class FunctionRef<R(Arguments...)> {
 public:
  template <class F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> && std::is_invocable_r_v<R, F&, Arguments...>)
  FunctionRef(F&& callable)
      : call_([](Target target, Arguments... arguments) -> R {
          using Callable = std::remove_reference_t<F>;
          if constexpr (std::is_function_v<Callable>)
            return reinterpret_cast<Callable*>(target.function)(std::forward<Arguments>(arguments)...);
          else
            return (*static_cast<Callable*>(target.object))(std::forward<Arguments>(arguments)...);
        }) {
    if constexpr (std::is_function_v<std::remove_reference_t<F>>)
      target_.function = reinterpret_cast<void (*)()>(&callable);
    else
      target_.object = const_cast<void*>(static_cast<const void*>(std::addressof(callable)));
  }

  R operator()(Arguments... arguments) const { return call_(target_, std::forward<Arguments>(arguments)...); }

 private:
  union Target {
    void* object;
    void (*function)();
  };
  Target target_;
  R (*call_)(Target, Arguments...);
};

}  // namespace carom::core
