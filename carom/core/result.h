// Errors as values: the library neither throws nor aborts on bad input, it says what was wrong.
#pragma once

#include <cassert>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

namespace carom::core {

/// One sentence for a person: what, where, what was found and what was expected.
struct Error {
  std::string message;
};

/// A value of type T, or the error that prevented it. Test it before use; value() of an error ends the program
/// with the message, which is the right thing in examples and tests and nowhere else.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Error error) : error_(std::move(error)) {}

  bool ok() const { return value_.has_value(); }
  explicit operator bool() const { return ok(); }
  const Error& error() const { return error_; }

  T& value() & {
    require();
    return *value_;
  }
  const T& value() const& {
    require();
    return *value_;
  }
  T&& value() && {
    require();
    return std::move(*value_);
  }
  T value_or(T fallback) const { return ok() ? *value_ : std::move(fallback); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }

 private:
  void require() const {
    if (ok()) return;
    std::fprintf(stderr, "carom: value() of an error: %s\n", error_.message.c_str());
    std::abort();
  }
  std::optional<T> value_;
  Error error_;
};

/// Success, or the error that prevented it.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}

  bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }
  const Error& error() const {
    assert(!ok());
    return *error_;
  }
  void value() const {
    if (ok()) return;
    std::fprintf(stderr, "carom: value() of an error: %s\n", error_->message.c_str());
    std::abort();
  }

 private:
  std::optional<Error> error_;
};

using Status = Result<void>;

}  // namespace carom::core
