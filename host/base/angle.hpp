// angle.hpp -- half a turn, a turn and a degree, in radians.
#pragma once

namespace clarity {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTurn = 2 * kPi;
inline constexpr double kRadPerDegree = kPi / 180;

}  // namespace clarity
