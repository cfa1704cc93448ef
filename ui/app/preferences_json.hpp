// preferences_json.hpp -- conversion of preferences to JSON and back.
#pragma once
#include <nlohmann/json.hpp>

#include "ui/app/preferences.hpp"

namespace clarity::ui {

nlohmann::json to_json(const Preferences& preferences);
// Values out of range are clamped; missing ones get their defaults. Throws nlohmann::json::exception if an entry has the wrong
// type. With `problems`, each such failure is appended there and the entry is left out; then it throws only if `json` is not an
// object.
Preferences preferences_from(const nlohmann::json& json, std::vector<std::string>* problems = nullptr);

}  // namespace clarity::ui
