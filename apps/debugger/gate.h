// Lets other threads at something while its owner waits.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>

namespace carom::debugger {

class Gate {
 public:
  /// Runs `work` while the owner waits in `open`, one caller after another. Blocks until then.
  void pass(const std::function<void()>& work) {
    std::unique_lock lock(mutex_);
    ++waiting_;
    opened_.wait(lock, [this] { return open_; });
    work();
    if (--waiting_ == 0) emptied_.notify_one();
  }

  /// The owner's: lets in whoever waits, for at most so long. What runs then ends first.
  void open(std::chrono::duration<double> most) {
    std::unique_lock lock(mutex_);
    if (waiting_ == 0) return;
    open_ = true;
    opened_.notify_all();
    emptied_.wait_for(lock, most, [this] { return waiting_ == 0; });
    open_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable opened_, emptied_;
  int waiting_ = 0;
  bool open_ = false;
};

}  // namespace carom::debugger
