#include "tools/lab/measure_materials.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.hpp"
#include "device/device.hpp"
#include "plugin/registry.hpp"
#include "stand/seed.hpp"
#include "tools/check/surfaces/hemisphere.hpp"
#include "tools/check/surfaces/model_checks.hpp"
#include "worker/child.hpp"

namespace clarity::lab {
namespace {

using check::Integrals;
using check::SurfaceAnswer;
using check::SurfaceProbe;
using check::SurfaceQuery;
using check::SurfaceSubject;

constexpr int kViews = 4;            // directions wo of a case
constexpr double kSameLight = 5e-3;  // share by which integrals of one light may differ: that of their own errors
constexpr double kSigmas = 5;        // of a mean; beyond it, the reason is not chance

constexpr double kAsking_s = 120;    // processor time of what is not the student's
constexpr double kGoodError = 0.01;  // relative standard error that counts as little noise

// Light that comes from all around, as seen from the surface. toward: a unit vector above it.
struct Light {
    const char* name;
    double (*radiance)(double cosine);  // to `toward`
};
constexpr Light kLights[] = {
    {"furnace", [](double) { return 1.0; }},
    {"sky", [](double cosine) { return 0.3 + 0.35 * (1 + cosine); }},
};
const Light& light_of(const Case& one) {
    for (const Light& light : kLights)
        if (one.scene == light.name) return light;
    std::string names;
    for (const Light& light : kLights) names += (names.empty() ? "" : ", ") + std::string(light.name);
    throw Error(Exit::usage, "case " + one.name + ": no light '" + one.scene + "'; there are " + names);
}

const rt_plugin* open_model(const std::string& path) {
    if (path.empty()) return nullptr;
    const PluginRecord record = load_plugin(path);
    if (!record.plugin || !rt_surface_of(record.plugin))
        throw Error(Exit::failed, path + ": is no model of surfaces: " + record.why);
    return record.plugin;
}

SurfaceSubject subject_of(const rt_plugin& plugin, const Case& one) {
    auto values = check::surface_defaults(plugin);
    const rt_surface& surface = *rt_surface_of(&plugin);
    for (const auto& [name, value] : one.keys) {
        rt_u32 i = 0;
        while (i < surface.key_count && name != surface.keys[i].name) ++i;
        if (i == surface.key_count) throw Error(Exit::usage, "case " + one.name + ": the model has no key '" + name + "'");
        values[i] = value;
    }
    return check::surface_subject(plugin, one.color, values);
}

// One wo of a case.
struct View {
    float wo[3];
    float toward[3];
    const Light* light;
    double radiance(const float* wi) const {
        return light->radiance(double(wi[0]) * toward[0] + double(wi[1]) * toward[1] + double(wi[2]) * toward[2]);
    }
};
std::vector<View> views_of(const Case& one) {
    std::mt19937 random = random_of(97, one.seed);
    const auto number = [&] { return double(random() >> 8) * 0x1p-24; };
    std::vector<View> views(kViews);
    for (int i = 0; i < kViews; ++i) {
        // From nearly along the surface to straight above.
        check::set_direction(0.08 + 0.9 * (i + number()) / kViews, number(), views[i].wo);
        check::set_direction(0.2 + 0.8 * number(), number(), views[i].toward);
        views[i].light = &light_of(one);
    }
    return views;
}

// The integrals of what one draw brings, and of its square, which are exact but for the integration's error: a lobe that is
// seldom drawn would be missing in a mean of draws.
struct Brought {
    double mean[3] = {}, square[3] = {};
    std::string lost;  // light that is never drawn; "": none
};
Brought brought(SurfaceProbe& probe, const SurfaceSubject& subject, const View& view, const std::vector<SurfaceAnswer>& drawn) {
    std::vector<check::Hint> hints;
    for (const SurfaceAnswer& answer : drawn)
        if (answer.drawn())
            hints.push_back(
                {check::place_of(answer.wi), double(answer.drawn_f[0]) * double(answer.wi[2]) * view.radiance(answer.wi)});
    Brought sum;
    const auto cells = check::even_cells(16);
    const auto integrals =
        check::integrate(probe, subject, view.wo, cells, hints, [&](const SurfaceQuery& query, const SurfaceAnswer& answer) {
            Integrals values{};
            for (size_t k = 0; k < 3; ++k) {
                const double light = double(answer.f[k]) * double(query.wi[2]) * view.radiance(query.wi);
                values[k] = light;
                if (light <= 0) continue;
                if (answer.density <= 0) {
                    if (sum.lost.empty())
                        sum.lost = "sample never finds light" + check::of_pair(query) + ": there pdf is 0, and eval is " +
                                   check::direction_text(answer.f);
                    continue;
                }
                values[3 + k] = light * light / double(answer.density);
            }
            return values;
        });
    for (const Integrals& cell : integrals)
        for (size_t k = 0; k < 3; ++k) sum.mean[k] += cell[k], sum.square[k] += cell[3 + k];
    return sum;
}

std::string color_text(const double* color) {
    char text[80];
    std::snprintf(text, sizeof text, "(%.5g, %.5g, %.5g)", color[0], color[1], color[2]);
    return text;
}

struct Fault {
    std::string text;  // "": nothing is wrong
    Wrong kind = Wrong::nothing;
};

// What is wrong with draws. Their mean should be `truth`.
Fault fault_of(SurfaceProbe& probe, const SurfaceSubject& subject, const View& view, const Brought& own, const double* truth,
               size_t draws, std::mt19937& random) {
    if (!own.lost.empty()) return {own.lost, Wrong::never_drawn};
    for (size_t k = 0; k < 3; ++k)
        if (!(std::fabs(own.mean[k] - truth[k]) <= kSameLight * truth[k] + 1e-5))
            return {"the light that is sent back by eval, integrated over all directions, is " + color_text(own.mean) +
                        check::of_wo(view.wo) + ", expected " + color_text(truth),
                    Wrong::eval_light};
    std::string biased;
    for (int again = 0; again < 2; ++again) {  // numbers of their own must confirm it
        const auto queries = check::random_draws(view.wo, draws, random);
        const auto answers = probe.ask(subject, queries);
        double mean[3] = {};
        for (size_t i = 0; i < answers.size(); ++i) {
            if (const std::string fault = check::number_fault(queries[i], answers[i]); !fault.empty())
                return {fault, Wrong::numbers};
            if (const std::string fault = check::weight_fault(queries[i], answers[i]); !fault.empty())
                return {fault, Wrong::weights};
            if (!answers[i].drawn()) continue;
            for (size_t k = 0; k < 3; ++k)
                mean[k] += double(answers[i].weight[k]) * view.radiance(answers[i].wi) / double(draws);
        }
        double worst = 0;
        for (size_t k = 0; k < 3; ++k) {
            const double variance = std::max(0.0, own.square[k] - own.mean[k] * own.mean[k]);
            const double error = std::sqrt(variance / double(draws)) + 1e-3 * truth[k] + 1e-6;
            worst = std::max(worst, std::fabs(mean[k] - truth[k]) / error);
        }
        if (worst < kSigmas) return {check::density_fault(probe, subject, view.wo, draws, random), Wrong::density};
        biased = "the mean of " + std::to_string(draws) + " draws is " + color_text(mean) + check::of_wo(view.wo) +
                 ", expected " + color_text(truth) + ", which is " + check::short_text(worst) +
                 " standard errors away: the draws are biased";
    }
    return {biased, Wrong::mean};
}

}  // namespace

void measure_materials(const MeasureJob& job, const std::function<void(const nlohmann::json&)>& report) {
    const rt_plugin *reference = open_model(job.reference), *student = open_model(job.library);
    worker::enter_sandbox(worker::WorkerKind::driver);
    const auto device = std::make_shared<Device>(choose_device(job.device));
    std::unique_ptr<SurfaceProbe> theirs, own;
    for (const Case& one : job.materials) {
        nlohmann::json figures;
        const std::vector<View> views = views_of(one);
        const size_t draws = one.rays;
        const auto first_draws = [&](SurfaceProbe& probe, const SurfaceSubject& subject, const View& view) {
            std::mt19937 random = random_of(98, one.seed);
            return probe.ask(subject, check::random_draws(view.wo, draws, random));
        };
        // Adds the draws that it takes until the standard error is kGoodError of the mean, at least one.
        double work = 0;
        const auto add_work = [&](const Brought& light) {
            double variance = 0, mean = 0;
            for (size_t k = 0; k < 3; ++k)
                variance += std::max(0.0, light.square[k] - light.mean[k] * light.mean[k]),
                    mean += light.mean[k] * light.mean[k];
            work += std::max(1.0, variance / std::max(mean, 1e-30) / (kGoodError * kGoodError)) / kViews;
        };
        std::vector<double> truth = one.truth;
        if (reference) {
            worker::say_step("asking the reference", kAsking_s);
            if (!theirs) theirs = std::make_unique<SurfaceProbe>(*reference, device);
            const SurfaceSubject subject = subject_of(*reference, one);
            truth.clear();
            for (const View& view : views) {
                const Brought light = brought(*theirs, subject, view, first_draws(*theirs, subject, view));
                if (!light.lost.empty()) throw Error(Exit::failed, light.lost);
                truth.insert(truth.end(), light.mean, light.mean + 3);
                add_work(light);
            }
            figures["reference_work"] = work, figures["truth"] = truth;
        }
        try {
            if (truth.size() != 3 * views.size())
                throw Error(Exit::failed,
                            "lab.json: this case has no `truth`; make the handout again by `clarity lab handout`");
            worker::say_step("compiling", kAsking_s);
            if (!own) own = std::make_unique<SurfaceProbe>(*student, device);
            const SurfaceSubject subject = subject_of(*student, one);
            std::mt19937 random = random_of(99, one.seed);
            Fault fault;
            work = 0;
            for (size_t i = 0; i < views.size() && fault.text.empty(); ++i) {
                worker::say_step("asking " + subject.what + check::of_wo(views[i].wo), job.limit_s);
                const Brought light = brought(*own, subject, views[i], first_draws(*own, subject, views[i]));
                fault = fault_of(*own, subject, views[i], light, &truth[3 * i], draws, random);
                add_work(light);
            }
            char text[120];
            std::snprintf(text, sizeof text, "%.4g draws until the standard error is 1 %%", work);
            if (!fault.text.empty()) figures["wrong"] = subject.what + ": " + fault.text, figures["kind"] = fault.kind;
            figures["found"] = text, figures["work"] = work;
        } catch (const Error& e) {
            figures["wrong"] = e.what(), figures["kind"] = wrong_of(e.failure(), Wrong::kernels);
        }
        report(figures);
    }
}

}  // namespace clarity::lab
