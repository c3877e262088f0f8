// Units in which sports publish their numbers, in SI.
#pragma once

namespace carom::sports::detail {

inline constexpr double degree = 3.14159265358979323846 / 180;  // rad
inline constexpr double mph = 0.44704;                          // m/s

}  // namespace carom::sports::detail
