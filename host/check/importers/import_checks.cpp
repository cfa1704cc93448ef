#include "check/importers/import_checks.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "base/error.hpp"
#include "base/lower.hpp"
#include "base/memory_text.hpp"
#include "base/numbers.hpp"
#include "check/process_size.hpp"
#include "import/sink/scene_builder.hpp"

namespace fs = std::filesystem;

namespace clarity::check {
namespace {

using Inputs = std::shared_ptr<const ImportInputs>;

constexpr double kSmallLimit_s = 7;  // processor time for a small file, as the program's own limit
constexpr const char* kNoSamples = "no sample files: name some with --samples FILE|DIR";

double limit_of(const std::string& path) {
    return kSmallLimit_s + 2.0 * double(fs::file_size(path)) / (1 << 20);
}
std::string name_of(const std::string& path) {
    return fs::path(path).filename().string();
}

// Notes which importer was chosen, and answers a certain progress report with "cancelled".
class Watch : public Progress, public import::ImportObserver {
 public:
    explicit Watch(unsigned cancel_at = 0) : cancel_at_(cancel_at) {}
    void running(const std::string&, const std::string& importer) override {
        if (first_.empty()) first_ = importer;
    }
    bool report(float) override {
        if (++reports_ == cancel_at_) cancel();
        return !cancelled();
    }
    const std::string& first() const { return first_; }
    unsigned reports() const { return reports_; }

 private:
    const unsigned cancel_at_;
    unsigned reports_ = 0;
    std::string first_;
};

struct Import {
    Scene scene;
    std::string importer;  // which was chosen
    std::string why;       // how it failed; empty: it did not
    bool cancelled = false;
    unsigned reports = 0;
};

Import import_file(const ImportInputs& inputs, const std::string& path, unsigned cancel_at = 0) {
    Import result;
    Watch watch(cancel_at);
    try {
        const import::FileAccess access({path}, {});
        import::SceneBuilder builder(inputs.plugins, {}, access, watch, &watch);
        builder.add_root(path);
        result.scene = builder.take();
    } catch (const Cancelled&) {
        result.cancelled = true;
    } catch (const std::bad_alloc&) {
        result.why = "out of memory";
    } catch (const std::exception& e) {
        result.why = e.what();
    }
    result.importer = watch.first();
    result.reports = watch.reports();
    return result;
}

// What is wrong with the result of a file that is in order; empty: nothing.
std::string fault_of(const ImportInputs& inputs, const Import& result) {
    if (result.cancelled) return "said that it was cancelled, but nobody had cancelled it";
    if (!result.why.empty()) return result.why;
    if (result.importer != inputs.plugin->id)
        return "is read by the importer " + result.importer + ": " + inputs.plugin->id +
               " has not its extension, or its `probe` is less sure";
    return validate(result.scene);
}

Outcome table(const ImportInputs& inputs, const Step& step) {
    const rt_importer& importer = *inputs.plugin->importer;
    if (!importer.extensions || !importer.extensions[0]) return Outcome::failed("it names no extension: no file can reach it");
    for (const char* const* e = importer.extensions; *e; ++e) {
        const std::string extension = *e;
        if (extension.empty() || extension[0] == '.' ||
            std::any_of(extension.begin(), extension.end(), [](char c) { return lower(c) != c; }))
            return Outcome::failed("the extension '" + extension + "' must be lower case, without a dot");
    }
    if (!importer.probe) return Outcome::passed("it goes by its extensions");
    step("asking `probe` about junk of any length", kSmallLimit_s);
    for (const Mutant& junk : junk())
        for (const size_t bytes : {size_t(0), size_t(1), size_t(3), size_t(17), size_t(4096)}) {
            const std::string head = junk.bytes.substr(0, bytes);
            const int32_t sure = importer.probe(reinterpret_cast<const uint8_t*>(head.data()), head.size());
            if (sure < 0 || sure > 100) return Outcome::failed("`probe` answers " + std::to_string(sure) + ", not 0 to 100");
            if (sure > 90)
                return Outcome::failed("`probe` is " + std::to_string(sure) + " % sure of " + junk.what + " (" +
                                       std::to_string(head.size()) + " bytes): it would take files of other importers");
        }
    return Outcome::passed("extensions and `probe` are in order");
}

Outcome read(const ImportInputs& inputs, const Step& step) {
    if (inputs.samples.empty()) return Outcome::skipped(kNoSamples);
    uint64_t triangles = 0;
    for (const std::string& path : inputs.samples) {
        step("reading " + path, limit_of(path));
        const Import result = import_file(inputs, path);
        if (const std::string why = fault_of(inputs, result); !why.empty()) return Outcome::failed(name_of(path) + ": " + why);
        triangles += result.scene.placed_triangle_count();
    }
    return Outcome::passed(std::to_string(inputs.samples.size()) + " files with " + std::to_string(triangles) + " triangles");
}

// How a scene differs from the truth; empty: it does not.
std::string difference(const Scene& scene, const Contents& truth) {
    const auto triangles = static_cast<double>(scene.placed_triangle_count());
    if (triangles != truth.triangles) return "has " + exact_text(triangles) + " triangles, not " + exact_text(truth.triangles);
    const double area = scene.surface_area();
    if (!(std::fabs(area - truth.area) <= 1e-3 * truth.area))
        return "has a surface of " + exact_text(area) + ", not " + exact_text(truth.area);
    const Bounds bounds = scene.bounds();
    double size = 0;
    for (int k = 0; k < 3; ++k) size = std::max(size, truth.hi[k] - truth.lo[k]);
    for (int k = 0; k < 3; ++k) {
        const double lo = bounds.min[k] + scene.origin[k], hi = bounds.max[k] + scene.origin[k];
        if (!(std::fabs(lo - truth.lo[k]) <= 1e-3 * size && std::fabs(hi - truth.hi[k]) <= 1e-3 * size))
            return std::string("goes from ") + exact_text(static_cast<float>(lo)) + " to " +
                   exact_text(static_cast<float>(hi)) + " along " + "xyz"[k] + ", not from " + exact_text(truth.lo[k]) +
                   " to " + exact_text(truth.hi[k]);
    }
    return {};
}

Outcome truth(const ImportInputs& inputs, const Step& step) {
    if (inputs.truths.empty())
        return Outcome::skipped("no truth about the samples: put FILE.json beside them, or name a folder with --truth DIR");
    for (const auto& [path, held] : inputs.truths) {
        step("reading " + path, limit_of(path));
        const Import result = import_file(inputs, path);
        std::string why = fault_of(inputs, result);
        if (why.empty()) why = difference(result.scene, held);
        if (!why.empty()) return Outcome::failed(name_of(path) + ": " + why);
    }
    return Outcome::passed("triangles, surface and box of " + std::to_string(inputs.truths.size()) + " files are right");
}

// Reads each sample after another one: an importer keeps no state.
Outcome state(const ImportInputs& inputs, const Step& step) {
    if (inputs.samples.empty()) return Outcome::skipped(kNoSamples);
    const size_t count = std::min<size_t>(inputs.samples.size(), 10);
    std::vector<Import> first;
    for (size_t i = 0; i < count; ++i) {
        step("reading " + inputs.samples[i], limit_of(inputs.samples[i]));
        first.push_back(import_file(inputs, inputs.samples[i]));
    }
    for (size_t i = count; i-- > 0;) {
        step("reading " + inputs.samples[i] + " again, after another file", limit_of(inputs.samples[i]));
        const Import again = import_file(inputs, inputs.samples[i]);
        const Scene &a = first[i].scene, &b = again.scene;
        if (again.why != first[i].why || a.positions != b.positions || a.triangles != b.triangles ||
            a.instances.size() != b.instances.size() || a.materials.size() != b.materials.size() ||
            a.lights.size() != b.lights.size() || a.cameras.size() != b.cameras.size())
            return Outcome::failed(name_of(inputs.samples[i]) +
                                   " gives another scene when it is read again: the plugin keeps state");
    }
    return Outcome::passed(std::to_string(count) + " files give the same scene again");
}

Outcome hostile(const ImportInputs& inputs, const Step& step) {
    size_t refused = 0, read = 0, others = 0;
    for (const HostileFile& file : inputs.hostile) {
        step("reading " + file.what + " (" + file.path + ")", limit_of(file.path));
        const Import result = import_file(inputs, file.path);
        const std::string of = file.what + " (" + file.path + "): ";
        if (result.importer != inputs.plugin->id) {
            ++others;
            continue;
        }
        if (result.why.find("out of memory") != std::string::npos)
            return Outcome::failed(of + "asks for more memory than a worker has, for a file of " +
                                   memory_text(fs::file_size(file.path)) + ": it trusts a count of the file");
        if (result.why.empty()) {
            if (const std::string why = validate(result.scene); !why.empty())
                return Outcome::failed(of + "gives a scene that is not sound: " + why);
            ++read;
        } else {
            ++refused;
        }
    }
    return Outcome::passed(std::to_string(refused) + " files refused, " + std::to_string(read) + " read as far as they go" +
                           (others ? ", " + std::to_string(others) + " left to other importers" : ""));
}

Outcome cancel(const ImportInputs& inputs, const Step& step) {
    if (inputs.samples.empty()) return Outcome::skipped(kNoSamples);
    const std::string& path = inputs.samples.back();  // the largest
    step("reading " + path, limit_of(path));
    const Import whole = import_file(inputs, path);
    if (const std::string why = fault_of(inputs, whole); !why.empty()) return Outcome::failed(name_of(path) + ": " + why);
    if (whole.reports == 0) return Outcome::skipped(name_of(path) + " is read without a call of host->progress");
    step("cancelling " + path, limit_of(path));
    const Import result = import_file(inputs, path, 1);
    if (!result.cancelled && !result.why.empty())
        return Outcome::failed(name_of(path) +
                               ": when it is cancelled, it fails instead of returning RT_CANCELLED: " + result.why);
    if (!result.cancelled && whole.reports > 1)
        return Outcome::failed(name_of(path) + ": host->progress returned 0 at report 1 of " + std::to_string(whole.reports) +
                               ", and it went on to the end: it must return RT_CANCELLED soon");
    return Outcome::passed("stops when it is told to");
}

Outcome leaks(const ImportInputs& inputs, const Step& step, bool quick) {
    if (inputs.samples.empty()) return Outcome::skipped(kNoSamples);
    const std::string& path = inputs.samples.front();  // the smallest
    return find_leaks("import", quick ? 40 : 100, [&](unsigned) {
        step("reading " + path + " again and again", limit_of(path));
        import_file(inputs, path);
    });
}

}  // namespace

std::vector<Check> import_checks(const Inputs& inputs, bool quick) {
    return {
        {"imports.table", "extensions and `probe`", [=](const Step& step) { return table(*inputs, step); }},
        {"imports.read", "reads the sample files", [=](const Step& step) { return read(*inputs, step); }},
        {"imports.truth", "triangles, surface and box of the samples are what others read",
         [=](const Step& step) { return truth(*inputs, step); }},
        {"imports.state", "no state is kept from file to file", [=](const Step& step) { return state(*inputs, step); }},
        {"imports.cancel", "an import stops when the user cancels it", [=](const Step& step) { return cancel(*inputs, step); }},
        {"imports.leaks", "no memory, file or thread is left behind by import after import",
         [=](const Step& step) { return leaks(*inputs, step, quick); }},
        {"imports.hostile", "damaged files and junk: an error or a sound scene, within the limits of memory and time",
         [=](const Step& step) { return hostile(*inputs, step); }},
    };
}

}  // namespace clarity::check
