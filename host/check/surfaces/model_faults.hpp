// model_faults.hpp -- what is wrong with answers of a model of surfaces. Each returns a text, which is empty if nothing is.
#pragma once
#include <random>
#include <string>

#include "check/surfaces/surface_probe.hpp"

namespace clarity::check {

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
