// figures.hpp -- how fast the pictures of a session come.
#pragma once
#include <string>

#include "ui/session/session.hpp"

namespace clarity::ui {

double frames_per_second(const Session& session, unsigned side = 0);  // over the last ten frames
double mrays_per_second(const Session& session, unsigned side = 0);   // of the newest picture, by the device's time
std::string frame_rate_line(const Session& session);                  // both, and the settings that they depend on

}  // namespace clarity::ui
