// preferences_json.hpp -- preferences as JSON, and back.
#pragma once
#include <nlohmann/json.hpp>

#include "ui/app/preferences.hpp"

namespace clarity::ui {

nlohmann::json to_json(const Preferences& preferences);
// Values out of range are brought into it, missing ones are the defaults. Throws nlohmann::json::exception for one of the wrong
// kind. problems: gets such failures instead, one for each entry that is left out; then only what is no object throws.
Preferences preferences_from(const nlohmann::json& json, std::vector<std::string>* problems = nullptr);

}  // namespace clarity::ui
