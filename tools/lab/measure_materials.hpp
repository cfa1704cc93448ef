// measure_materials.hpp -- what a model of surfaces is worth on the materials of a lab: whether it is right, and how many draws
// it takes until little noise is left.
#pragma once
#include <functional>

#include <nlohmann/json.hpp>

#include "tools/lab/measure.hpp"

namespace clarity::lab {

// In the worker. Reports each case, in the form of measure.cpp.
void measure_materials(const MeasureJob& job, const std::function<void(const nlohmann::json&)>& report);

}  // namespace clarity::lab
