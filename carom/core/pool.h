// Slots with generations: who issues handles and who recognises a stale, foreign or null one.
#pragma once

#include <string_view>
#include <vector>

#include "carom/core/handle.h"
#include "carom/core/result.h"
#include "carom/core/string.h"

namespace carom::core {

enum class HandleFault : std::uint8_t { none, null, foreign, stale };

/// "is the null handle", "belongs to another world", …: the end of a sentence.
constexpr std::string_view to_string(HandleFault fault) {
  switch (fault) {
    case HandleFault::none:
      return "is valid";
    case HandleFault::null:
      return "is the null handle";
    case HandleFault::foreign:
      return "belongs to another world";
    case HandleFault::stale:
      return "names something that no longer exists";
  }
  return "";
}

/// Issues handles to slots 0, 1, 2, …; the caller keeps the data in arrays indexed by slot. The slot freed last is
/// reused first, so that the same calls give the same handles on every machine. A copy is a snapshot. A slot whose
/// 65 535 generations are used up is never issued again, so an old handle cannot come back to life.
template <class Tag>
class SlotPool {
 public:
  using HandleType = Handle<Tag>;

  /// `world` goes into every handle and tells foreign ones.
  explicit SlotPool(std::uint16_t world = 0) : world_(world) {}

  std::uint16_t world() const { return world_; }
  int size() const { return size_; }                         ///< slots in use
  int capacity() const { return int(generations_.size()); }  ///< slots ever used: bound of every slot index
  void reserve(int slots) {
    generations_.reserve(std::size_t(slots));
    next_free_.reserve(std::size_t(slots));
  }

  HandleType allocate() {
    std::uint32_t slot;
    if (first_free_ != no_slot) {
      slot = first_free_;
      first_free_ = next_free_[slot];
    } else {
      slot = std::uint32_t(generations_.size());
      generations_.push_back(0);
      next_free_.push_back(no_slot);
    }
    next_free_[slot] = used;
    ++generations_[slot];
    ++size_;
    return handle_at(int(slot));
  }

  /// The handle must be valid.
  void release(HandleType handle) {
    assert(contains(handle));
    const std::uint32_t slot = handle.index - 1;
    --size_;
    if (generations_[slot] == 0xFFFF) {
      next_free_[slot] = retired;
      return;
    }
    next_free_[slot] = first_free_;
    first_free_ = slot;
  }

  HandleFault fault(HandleType handle) const {
    if (handle.is_null()) return HandleFault::null;
    if (handle.world != world_) return HandleFault::foreign;
    const std::size_t slot = handle.index - 1;
    if (slot >= generations_.size() || next_free_[slot] != used || generations_[slot] != handle.generation)
      return HandleFault::stale;
    return HandleFault::none;
  }
  bool contains(HandleType handle) const { return fault(handle) == HandleFault::none; }

  /// `noun` names the handle in the message: "body", "joint.body_a".
  Status check(HandleType handle, std::string_view noun) const {
    const HandleFault f = fault(handle);
    if (f == HandleFault::none) return {};
    if (f == HandleFault::null) return Error{text(noun, ": ", to_string(f))};
    return Error{text(noun, ": handle #", handle.index, " (generation ", handle.generation, ") ", to_string(f))};
  }

  static int slot(HandleType handle) { return int(handle.index) - 1; }
  bool in_use(int slot) const { return next_free_[std::size_t(slot)] == used; }
  /// Of a slot in use.
  HandleType handle_at(int slot) const { return {std::uint32_t(slot) + 1, generations_[std::size_t(slot)], world_}; }

  void clear() {
    for (int slot = capacity() - 1; slot >= 0; --slot)
      if (in_use(slot)) release(handle_at(slot));
  }
  std::size_t bytes() const {
    return generations_.capacity() * sizeof(std::uint16_t) + next_free_.capacity() * sizeof(std::uint32_t);
  }
  /// For who restores one: is every slot used, retired or once in the list of free ones?
  bool sound() const {
    if (next_free_.size() != generations_.size()) return false;
    std::size_t in_use = 0, free = 0;
    for (const std::uint32_t next : next_free_)
      if (next == used)
        ++in_use;
      else if (next != retired)
        ++free;
    std::uint32_t slot = first_free_;
    for (; free > 0 && slot < next_free_.size(); --free) slot = next_free_[slot];
    return free == 0 && slot == no_slot && size_ >= 0 && in_use == std::size_t(size_);
  }
  /// Calls visit(member) for everything that changes: for who saves and restores the pool. `pool` may be const.
  template <class Pool, class Visit>
  static void visit_members(Pool& pool, Visit&& visit) {
    visit(pool.generations_);
    visit(pool.next_free_);
    visit(pool.first_free_);
    visit(pool.size_);
  }

 private:
  static constexpr std::uint32_t no_slot = 0xFFFFFFFF, used = 0xFFFFFFFE, retired = 0xFFFFFFFD;
  std::vector<std::uint16_t> generations_;
  std::vector<std::uint32_t> next_free_;
  std::uint32_t first_free_ = no_slot;
  int size_ = 0;
  std::uint16_t world_ = 0;
};

/// Values in slots. References are good until the next insertion.
template <class T, class Tag>
class Pool {
 public:
  using HandleType = Handle<Tag>;
  explicit Pool(std::uint16_t world = 0) : slots_(world) {}

  HandleType insert(T value) {
    const HandleType handle = slots_.allocate();
    const std::size_t slot = std::size_t(SlotPool<Tag>::slot(handle));
    if (slot == values_.size())
      values_.push_back(std::move(value));
    else
      values_[slot] = std::move(value);
    return handle;
  }
  /// The handle must be valid.
  void erase(HandleType handle) {
    slots_.release(handle);
    values_[std::size_t(SlotPool<Tag>::slot(handle))] = T{};
  }
  /// Null where the handle is not valid.
  T* find(HandleType handle) {
    return slots_.contains(handle) ? &values_[std::size_t(SlotPool<Tag>::slot(handle))] : nullptr;
  }
  const T* find(HandleType handle) const {
    return slots_.contains(handle) ? &values_[std::size_t(SlotPool<Tag>::slot(handle))] : nullptr;
  }
  Status check(HandleType handle, std::string_view noun) const { return slots_.check(handle, noun); }
  const SlotPool<Tag>& slots() const { return slots_; }
  int size() const { return slots_.size(); }
  T& at_slot(int slot) { return values_[std::size_t(slot)]; }
  const T& at_slot(int slot) const { return values_[std::size_t(slot)]; }

 private:
  SlotPool<Tag> slots_;
  std::vector<T> values_;
};

}  // namespace carom::core
