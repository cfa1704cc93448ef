#include "tools/check/surfaces/model_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/angle.hpp"
#include "stand/seed.hpp"
#include "tools/check/surfaces/hemisphere.hpp"

namespace clarity::check {
namespace {

constexpr double kCompile_s = 40, kAsk_s = 20;  // processor time of steps
constexpr std::array<float, 3> kWhite{1, 1, 1}, kBlack{0, 0, 0}, kColor{0.9f, 0.5f, 0.2f};
// Cosines of wo to the normal, from straight above to nearly along the surface.
constexpr double kCosines[] = {1, 0.8, 0.4, 0.1};
// Also closer to the surface than a picture's rays usually come.
constexpr double kGrazingCosines[] = {1, 0.5, 0.1, 1e-2, 1e-3, 1e-6};

class ModelStand {
 public:
    ModelStand(const rt_plugin& plugin, std::function<std::shared_ptr<Device>()> open, bool quick, uint64_t seed)
        : plugin_(plugin), open_(std::move(open)), quick_(quick), seed_(seed) {}
    SurfaceProbe& probe(const Step& step) {
        if (!probe_) {
            step("opening the device and compiling the three functions", kCompile_s);
            probe_ = std::make_unique<SurfaceProbe>(plugin_, open_());
        }
        return *probe_;
    }
    std::vector<SurfaceSubject> subjects(const std::array<float, 3>& color) const { return surface_subjects(plugin_, color); }
    size_t draws() const { return quick_ ? 20000 : 200000; }
    size_t pairs() const { return quick_ ? 4000 : 40000; }
    std::mt19937 random(unsigned own) const { return random_of(own, seed_); }
    // What a person does to see it.
    static std::string to_see(const SurfaceSubject& subject) {
        return "to see it, give " + subject.what + " to the material of a sphere and render it with --tracer path";
    }

 private:
    const rt_plugin& plugin_;
    const std::function<std::shared_ptr<Device>()> open_;
    const bool quick_;
    const uint64_t seed_;
    std::unique_ptr<SurfaceProbe> probe_;
};

Outcome failed(const SurfaceSubject& subject, const std::string& found) {
    return Outcome::failed(subject.what + ": " + found, ModelStand::to_see(subject));
}

// Calls try_one with each material of these colours and each wo. Returns the first failure, or how many were tried.
template <size_t N>
Outcome each(ModelStand& stand, const Step& step, const std::vector<std::array<float, 3>>& colors, const double (&cosines)[N],
             const std::function<Outcome(SurfaceProbe&, const SurfaceSubject&, const float*)>& try_one) {
    SurfaceProbe& probe = stand.probe(step);
    size_t tried = 0;
    for (const auto& color : colors)
        for (const SurfaceSubject& subject : stand.subjects(color))
            for (const double cosine : cosines) {
                float wo[3];
                set_direction(cosine, 0.37 * double(++tried), wo);  // from all around
                step("asking " + subject.what + of_wo(wo), kAsk_s);
                const Outcome outcome = try_one(probe, subject, wo);
                if (outcome.kind != Outcome::Kind::passed) return outcome;
            }
    return Outcome::passed("right in " + std::to_string(tried) + " cases of keys, colour and wo");
}

Outcome compiles(ModelStand& stand, const Step& step) {
    stand.probe(step);
    return Outcome::passed("they need nothing but the contract of rt_surface.h");
}

Outcome finite(ModelStand& stand, const Step& step) {
    std::mt19937 random = stand.random(91);
    return each(stand, step, {kWhite, kBlack, kColor}, kGrazingCosines,
                [&](SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo) {
                    auto queries = random_draws(wo, stand.pairs(), random);
                    for (size_t i = 0; i < queries.size(); ++i) {
                        SurfaceQuery& query = queries[i];
                        const double near = i % 2 ? kGrazingCosines[i / 2 % std::size(kGrazingCosines)] : double(query.u[0]);
                        // Many opposite to wo, or on its side: there formulas divide by little.
                        const double turn = std::atan2(wo[1], wo[0]) / (2 * kPi) + (i % 3 ? 0.5 * (i % 3 - 1) : query.u[1]);
                        set_direction(std::max(near, 1e-6), turn, query.wi);
                        if (i < 27)  // the ends of each number
                            for (size_t k = 0, digits = i; k < 3; ++k, digits /= 3)
                                query.u[k] = digits % 3 == 0 ? 0 : digits % 3 == 1 ? 0.5f : 1 - 0x1p-24f;
                    }
                    const auto answers = probe.ask(subject, queries);
                    for (size_t i = 0; i < answers.size(); ++i)
                        if (const std::string fault = number_fault(queries[i], answers[i]); !fault.empty())
                            return failed(subject, fault);
                    return Outcome::passed("");
                });
}

Outcome weights(ModelStand& stand, const Step& step) {
    std::mt19937 random = stand.random(92);
    size_t drawn = 0;
    Outcome outcome =
        each(stand, step, {kColor}, kCosines, [&](SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo) {
            const auto queries = random_draws(wo, stand.pairs(), random);
            const auto answers = probe.ask(subject, queries);
            for (size_t i = 0; i < answers.size(); ++i) {
                drawn += answers[i].drawn();
                if (const std::string fault = weight_fault(queries[i], answers[i]); !fault.empty())
                    return failed(subject, fault);
            }
            return Outcome::passed("");
        });
    if (outcome.kind == Outcome::Kind::passed && drawn == 0) return Outcome::failed("sample never draws a direction");
    return outcome;
}

Outcome reciprocity(ModelStand& stand, const Step& step) {
    std::mt19937 random = stand.random(93);
    return each(stand, step, {kColor}, kCosines, [&](SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo) {
        auto there = random_draws(wo, stand.pairs(), random), back = there;
        for (size_t i = 0; i < there.size(); ++i) {
            set_direction(0.02 + 0.98 * double(there[i].u[0]), double(there[i].u[1]), there[i].wi);
            std::copy_n(there[i].wi, 3, back[i].wo);
            std::copy_n(wo, 3, back[i].wi);
        }
        const auto forth = probe.ask(subject, there), reverse = probe.ask(subject, back);
        for (size_t i = 0; i < there.size(); ++i)
            for (int k = 0; k < 3; ++k)
                if (!nearly_equal(double(forth[i].f[k]), double(reverse[i].f[k])))
                    return failed(subject, "eval is " + direction_text(forth[i].f) + of_pair(there[i]) + ", but " +
                                               direction_text(reverse[i].f) + " with wo and wi in each other's place");
        return Outcome::passed("");
    });
}

Outcome total(ModelStand& stand, const Step& step) {
    std::mt19937 random = stand.random(96);
    double greatest = 0;
    Outcome outcome =
        each(stand, step, {kColor}, kCosines, [&](SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo) {
            const double sum = DrawCells(probe, subject, wo, random).total();
            greatest = std::max(greatest, sum);
            if (sum <= 1.01) return Outcome::passed("");  // NaN fails; 1 % is for the integration
            return failed(subject,
                          "the integral of pdf over the hemisphere is " + short_text(sum) + of_wo(wo) + ", expected at most 1");
        });
    if (outcome.kind == Outcome::Kind::passed) outcome.found += "; the greatest integral is " + short_text(greatest);
    return outcome;
}

Outcome density(ModelStand& stand, const Step& step) {
    std::mt19937 random = stand.random(94);
    return each(stand, step, {kColor}, kCosines, [&](SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo) {
        const std::string fault = density_fault(probe, subject, wo, stand.draws(), random);
        return fault.empty() ? Outcome::passed("") : failed(subject, fault);
    });
}

Outcome energy(ModelStand& stand, const Step& step) {
    std::mt19937 random = stand.random(95);
    double greatest = 0;
    Outcome outcome =
        each(stand, step, {kWhite}, kCosines, [&](SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo) {
            double mean = 0, error = 0;
            for (int again = 0; again < 2; ++again) {  // as in density()
                const auto answers = probe.ask(subject, random_draws(wo, stand.draws(), random));
                mean = 0;
                for (int k = 0; k < 3; ++k) {
                    double sum = 0, squares = 0;
                    for (const SurfaceAnswer& a : answers) {
                        const double weight = a.drawn() ? double(a.weight[k]) : 0;
                        sum += weight, squares += weight * weight;
                    }
                    const double n = double(answers.size()), m = sum / n;
                    if (k > 0 && m <= mean) continue;
                    mean = m, error = std::sqrt(std::max(0.0, squares / n - m * m) / n);
                }
                if (mean <= 1 + 1e-3 + 4 * error) {
                    greatest = std::max(greatest, mean);
                    return Outcome::passed("");
                }
            }
            return failed(subject, "it sends back " + short_text(mean) +
                                       " of the light (the mean weight, with a standard error of " + short_text(error) + ")" +
                                       of_wo(wo) + ", expected at most 1");
        });
    if (outcome.kind == Outcome::Kind::passed) outcome.found += "; it sends back at most " + short_text(greatest);
    return outcome;
}

std::string of_draw(const SurfaceQuery& query) {
    return of_wo(query.wo) + " and u " + direction_text(query.u);
}

}  // namespace

std::vector<Check> model_checks(const rt_plugin& plugin, const std::function<std::shared_ptr<Device>()>& open, bool quick,
                                uint64_t seed) {
    const auto stand = std::make_shared<ModelStand>(plugin, open, quick, seed);
    const auto check = [&](const char* name, const char* tried, Outcome (*run)(ModelStand&, const Step&)) {
        return check_of(stand, name, tried, run);
    };
    return {
        check("surface.kernels", "the three functions compile alone", compiles),
        check("surface.finite", "numbers are finite and not negative, also along the surface and at the ends of u", finite),
        check("surface.weight", "weights are f cos / pdf", weights),
        check("surface.reciprocity", "f(a, b) = f(b, a)", reciprocity),
        check("surface.total", "the pdf integrates to at most 1", total),
        check("surface.density", "directions are drawn with the density pdf", density),
        check("surface.energy", "no more light is sent back than comes, where color is 1", energy),
    };
}

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
