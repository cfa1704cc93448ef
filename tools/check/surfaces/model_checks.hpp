// model_checks.hpp -- whether the three functions of a model of surfaces (rt_surface.h) agree with each other, and with
// physics.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "rt_plugin.h"
#include "tools/check/steps.hpp"
#include "tools/check/surfaces/surface_probe.hpp"

namespace clarity::check {

// open: opens the device on first use. seed: see seed.hpp.
std::vector<Check> model_checks(const rt_plugin& plugin, const std::function<std::shared_ptr<Device>()>& open, bool quick,
                                uint64_t seed);

// What is wrong with answers of a model of surfaces. Each returns a text, which is empty if nothing is.

std::string short_text(double x);
std::string of_wo(const float* wo);              // " for wo (0, 0, 1)"
std::string of_pair(const SurfaceQuery& query);  // of wo and wi
bool nearly_equal(double a, double b);

// A number is negative or none, or a drawn direction no unit vector.
std::string number_fault(const SurfaceQuery& query, const SurfaceAnswer& answer);
// The weight of a drawn direction is not f cos / pdf, or its pdf another one than that of pdf().
std::string weight_fault(const SurfaceQuery& query, const SurfaceAnswer& answer);
// Directions are not drawn with the density pdf.
std::string density_fault(SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo, size_t draws,
                          std::mt19937& random);

}  // namespace clarity::check
