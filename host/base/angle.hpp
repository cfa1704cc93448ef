// angle.hpp -- half a turn, and degrees, in radians.
#pragma once

namespace clarity {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kRadPerDegree = kPi / 180;

}  // namespace clarity
