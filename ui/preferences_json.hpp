// preferences_json.hpp -- preferences as JSON, and back.
#pragma once
#include <nlohmann/json.hpp>

#include "ui/preferences.hpp"

namespace clarity {

nlohmann::json to_json(const Preferences& preferences);
// Values out of range are brought into it, missing ones are the defaults. Throws nlohmann::json::exception for one of the wrong
// kind.
Preferences preferences_from(const nlohmann::json& json);

}  // namespace clarity
