#include "check/surfaces/model_faults.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "check/surfaces/directions.hpp"

namespace clarity::check {
namespace {

std::string of_draw(const SurfaceQuery& query) {
    return of_wo(query.wo) + " and u " + direction_text(query.u);
}

}  // namespace

std::string short_text(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
}
std::string of_wo(const float* wo) {
    return " for wo " + direction_text(wo);
}
std::string of_pair(const SurfaceQuery& query) {
    return of_wo(query.wo) + " and wi " + direction_text(query.wi);
}
bool nearly_equal(double a, double b) {
    return std::fabs(a - b) <= 1e-3 * std::max(std::fabs(a), std::fabs(b)) + 1e-6;
}

std::string number_fault(const SurfaceQuery& query, const SurfaceAnswer& answer) {
    const auto wrong = [](float x) { return !std::isfinite(x) || x < 0; };
    const auto any_wrong = [&](const float* v) { return std::any_of(v, v + 3, wrong); };
    const std::string expected = "; expected finite numbers, and none below 0";
    if (any_wrong(answer.f)) return "eval is " + direction_text(answer.f) + of_pair(query) + expected;
    if (wrong(answer.density)) return "pdf is " + short_text(double(answer.density)) + of_pair(query) + expected;
    if (wrong(answer.pdf)) return "sample's pdf is " + short_text(double(answer.pdf)) + of_draw(query) + expected;
    if (answer.pdf == 0) return {};
    const double length = std::hypot(double(answer.wi[0]), double(answer.wi[1]), double(answer.wi[2]));
    if (!(std::fabs(length - 1) < 1e-3))
        return "sample draws " + direction_text(answer.wi) + ", which is no unit vector," + of_draw(query);
    if (answer.drawn() && any_wrong(answer.weight))
        return "sample's weight is " + direction_text(answer.weight) + of_draw(query) + expected;
    return {};
}

std::string weight_fault(const SurfaceQuery& query, const SurfaceAnswer& answer) {
    if (!answer.drawn()) return {};
    const auto where = [&] { return of_draw(query) + ", which draws wi " + direction_text(answer.wi); };
    const double pdf = double(answer.pdf), density = double(answer.drawn_density);
    if (!nearly_equal(pdf, density))
        return "sample's pdf is " + short_text(pdf) + ", but pdf() says " + short_text(density) + where();
    for (size_t k = 0; k < 3; ++k) {
        const double weight = double(answer.weight[k]), wanted = double(answer.drawn_f[k]) * double(answer.wi[2]) / pdf;
        if (!nearly_equal(weight, wanted))
            return "the weight of colour " + std::to_string(k) + " is " + short_text(weight) + ", but f cos / pdf is " +
                   short_text(wanted) + where();
    }
    return {};
}

std::string density_fault(SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo, size_t draws,
                          std::mt19937& random) {
    const DrawCells cells(probe, subject, wo, random);
    Misfit misfit;
    // By chance 4 sigma are passed in one of 30,000 cases; so numbers of their own must confirm it.
    for (int again = 0; again < 2; ++again) {
        misfit = cells.misfit_of(probe.ask(subject, random_draws(wo, draws, random)));
        if (misfit.sigmas < 4) return {};
    }
    return "the directions of sample do not have the density pdf" + of_wo(wo) + ": " + misfit.worst +
           "; the chi-square of all cells is off by " + short_text(misfit.sigmas) + " sigma, expected less than 4";
}

}  // namespace clarity::check
