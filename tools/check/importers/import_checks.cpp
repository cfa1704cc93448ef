#include "tools/check/importers/import_checks.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <set>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "base/text.hpp"
#include "import/sink/scene_builder.hpp"
#include "import/wire.hpp"
#include "tools/check/importers/scene_difference.hpp"
#include "tools/check/process_size.hpp"

namespace fs = std::filesystem;

namespace clarity::check {
namespace {

using Inputs = std::shared_ptr<const ImportInputs>;

// What memory holds before a program writes to it: zeros as long as it is new, anything later.
[[gnu::noinline]] void fill_stack(uint8_t byte) {
    volatile uint8_t below[256 << 10];
    for (volatile uint8_t& at : below) at = byte;
}

// glibc keeps up to seven freed blocks of each size up to 1032 bytes, and hands them out again without filling them.
void fill_kept_blocks(uint8_t byte) {
    constexpr size_t kLargest = 1032, kStep = 16, kOfEach = 16;
    for (size_t bytes = 24; bytes <= kLargest; bytes += kStep) {
        void* blocks[kOfEach];
        for (void*& block : blocks) {
            block = std::malloc(bytes);
            if (!block) continue;
            std::memset(block, byte, bytes);
            asm volatile("" : : "r"(block) : "memory");  // or the compiler would leave the filling out
        }
        for (void* block : blocks) std::free(block);
    }
}

// Fills what malloc() and the stack will give to code that runs next on this thread with copies of one byte, as far as that
// can be reached: blocks that malloc() keeps for reuse, blocks that it makes (until the next call), and 256 KiB of stack.
void fill_fresh_memory(uint8_t byte) {
    mallopt(M_PERTURB, byte ^ 0xFF);  // fills new blocks with the complement
    fill_kept_blocks(byte);
    fill_stack(byte);
}

// malloc() fills nothing any more.
void leave_fresh_memory() {
    mallopt(M_PERTURB, 0);
}

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
    Failure failure = Failure::other;
    bool cancelled = false;
    unsigned reports = 0;
    size_t flat = 0;  // instances that flatten their mesh
};

Import import_file(const ImportInputs& inputs, const std::string& path, unsigned cancel_at = 0, bool undeformed = false) {
    Import result;
    import::ImporterParameters parameters;
    if (undeformed) parameters = import::parse_importer_choices(inputs.plugins, {import::kUndeformed});
    Watch watch(cancel_at);
    try {
        const import::FileAccess access({path}, {});
        import::SceneBuilder builder(inputs.plugins, parameters, access, watch, &watch);
        builder.add_root(path);
        const size_t meshes = builder.scene().meshes.size();
        result.scene = builder.take();
        result.flat = result.scene.meshes.size() - meshes;  // such an instance gets a flattened copy of its mesh
    } catch (const Cancelled&) {
        result.cancelled = true;
    } catch (const std::bad_alloc&) {
        result.why = "out of memory", result.failure = Failure::no_memory;
    } catch (const Error& e) {
        result.why = e.what(), result.failure = e.failure();
    } catch (const std::exception& e) {
        result.why = e.what();
    }
    result.importer = watch.first();
    result.reports = watch.reports();
    return result;
}

std::string digest_of(const Import& result) {
    return result.why.empty() ? import::scene_digest(result.scene) : result.why;
}

// What of a scene is not in the world, though it is there; empty: nothing. truth: of the file; nullptr: none.
std::string fault_of_placing(const Import& result, const Contents* truth) {
    const Scene& scene = result.scene;
    std::vector<uint8_t> placed(scene.meshes.size(), 0);
    for (const Instance& instance : scene.instances) placed[instance.mesh] = placed[instance.moving_mesh] = 1;
    const bool other = !scene.spheres.empty() || !scene.planes.empty() || !scene.polygons.empty() || !scene.shapes.empty();
    if (scene.placed_triangle_count() == 0 && !other && !(truth && truth->triangles == 0.0))
        return scene.triangles.empty() ? "holds no surface; if that is so, say \"triangles\": 0 in its truth"
                                       : "places none of its " + std::to_string(scene.triangle_count()) +
                                             " triangles: a mesh is in the world where sink->instance puts it";
    const double expected = truth && truth->flat ? *truth->flat : 0;
    if (double(result.flat) != expected)
        return "has " + std::to_string(result.flat) + " instances with a singular transform, which flatten their meshes, not " +
               exact_text(expected) + (expected == 0 ? "; if the file is so, say \"flat\": N in its truth" : "");
    if (result.flat > 0) return {};  // the meshes that were copied are there, too
    for (size_t i = 0; i < placed.size(); ++i)
        if (!placed[i] && scene.meshes[i].triangle_count > 0 && scene.motion.sequences.empty())
            return "has a mesh without an instance, number " + std::to_string(i) +
                   (scene.meshes[i].name.empty() ? "" : " (" + scene.meshes[i].name + ")") + " of " +
                   std::to_string(scene.meshes[i].triangle_count) + " triangles, which is not in the world";
    return {};
}

// What is wrong with the result of a file that is in order; empty: nothing.
std::string fault_of(const ImportInputs& inputs, const std::string& path, const Import& result) {
    if (result.cancelled) return "said that it was cancelled, but nobody had cancelled it";
    if (!result.why.empty()) return result.why;
    if (result.importer != inputs.plugin->id)
        return "is read by the importer " + result.importer + ": " + inputs.plugin->id +
               " has not its extension, or its `probe` is less sure";
    if (const Problem why = validate(result.scene)) return why.text();
    const auto truth = inputs.truths.find(path);
    return fault_of_placing(result, truth == inputs.truths.end() ? nullptr : &truth->second);
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
        if (const std::string why = fault_of(inputs, path, result); !why.empty())
            return Outcome::failed(name_of(path) + ": " + why);
        triangles += result.scene.placed_triangle_count();
    }
    return Outcome::passed(std::to_string(inputs.samples.size()) + " files with " + std::to_string(triangles) + " triangles");
}

Outcome truth(const ImportInputs& inputs, const Step& step) {
    if (inputs.truths.empty())
        return Outcome::skipped("no truth about the samples: put FILE.json beside them, or name a folder with --truth DIR");
    std::set<std::string> keys;
    for (const auto& [path, held] : inputs.truths) {
        keys.insert(held.keys);
        step("reading " + path, limit_of(path));
        const Import result = import_file(inputs, path, 0, held.undeformed);
        std::string why = fault_of(inputs, path, result);
        if (why.empty()) why = difference(result.scene, held);
        if (!why.empty()) return Outcome::failed(name_of(path) + ": " + why);
    }
    std::string list;
    for (const std::string& some : keys) list += (list.empty() ? "" : "; ") + some;
    return Outcome::passed("what is stated about " + std::to_string(inputs.truths.size()) + " files is right (" + list + ")");
}

// Reads each sample with two kinds of fresh memory: what differs has not been written by the plugin.
Outcome memory(const ImportInputs& inputs, const Step& step) {
    if (inputs.samples.empty()) return Outcome::skipped(kNoSamples);
    // As floats both are finite, so that a wrong number is compared and not refused.
    constexpr uint8_t kFills[] = {0x3C, 0xC1};
    for (const std::string& path : inputs.samples) {
        Import results[2];
        for (size_t i = 0; i < 2; ++i) {
            step("reading " + path + " with fresh memory of bytes " + std::to_string(kFills[i]), limit_of(path));
            fill_fresh_memory(kFills[i]);
            results[i] = import_file(inputs, path);
            leave_fresh_memory();
        }
        std::string why;
        if (results[0].why != results[1].why)
            why = "'" + results[0].why + "' and '" + results[1].why + "'";
        else
            why = difference(results[0].scene, results[1].scene);
        if (!why.empty())
            return Outcome::failed(name_of(path) +
                                   " becomes another scene when fresh memory holds other bytes, so the plugin uses memory that "
                                   "it has not written: " +
                                   why);
    }
    return Outcome::passed(std::to_string(inputs.samples.size()) + " files do not depend on what fresh memory holds");
}

// Reads each sample after others, forwards and backwards: an importer keeps no state.
Outcome state(const ImportInputs& inputs, const Step& step) {
    if (inputs.samples.empty()) return Outcome::skipped(kNoSamples);
    const size_t count = std::min(inputs.samples.size(), kMostAlone);
    std::vector<Import> first;
    const auto failed = [](const std::string& path, const std::string& when, const std::string& why) {
        return Outcome::failed(name_of(path) + " gives another scene " + when + ": the plugin keeps state: " + why);
    };
    for (size_t i = 0; i < count; ++i) {
        const std::string& path = inputs.samples[i];
        step("reading " + path, limit_of(path));
        first.push_back(import_file(inputs, path));
        const auto alone = inputs.alone.find(path);
        if (alone != inputs.alone.end() && alone->second != digest_of(first.back()))
            return failed(path, "in a process that has read nothing before",
                          "its digest is " + alone->second + " there and " + digest_of(first.back()) + " after others");
    }
    for (size_t i = count; i-- > 0;) {
        const std::string& path = inputs.samples[i];
        step("reading " + path + " again, after another file", limit_of(path));
        const Import again = import_file(inputs, path);
        if (again.why != first[i].why) return failed(path, "when it is read again", "'" + again.why + "'");
        if (const std::string why = difference(first[i].scene, again.scene); !why.empty())
            return failed(path, "when it is read again", why);
    }
    return Outcome::passed(std::to_string(count) + " files give the same scene alone, and after others");
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
        if (result.failure == Failure::no_memory)
            return Outcome::failed(of + "asks for more memory than a worker has, for a file of " +
                                   memory_text(fs::file_size(file.path)) + ": it trusts a count of the file");
        if (result.why.empty()) {
            if (const Problem why = validate(result.scene))
                return Outcome::failed(of + "gives a scene that is not sound: " + why.text());
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
    if (const std::string why = fault_of(inputs, path, whole); !why.empty()) return Outcome::failed(name_of(path) + ": " + why);
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

std::string import_digest(const ImportInputs& inputs, const std::string& path) {
    return digest_of(import_file(inputs, path));
}

std::vector<Check> import_checks(const Inputs& inputs, bool quick) {
    return {
        {"imports.table", "extensions and `probe`", [=](const Step& step) { return table(*inputs, step); }},
        {"imports.read", "reads the sample files", [=](const Step& step) { return read(*inputs, step); }},
        {"imports.truth", "what others read from the samples, or their authors know of them",
         [=](const Step& step) { return truth(*inputs, step); }},
        {"imports.memory", "nothing depends on what fresh memory holds",
         [=](const Step& step) { return memory(*inputs, step); }},
        {"imports.state", "no state is kept from file to file", [=](const Step& step) { return state(*inputs, step); }},
        {"imports.cancel", "an import stops when the user cancels it", [=](const Step& step) { return cancel(*inputs, step); }},
        {"imports.leaks", "no memory, file or thread is left behind by import after import",
         [=](const Step& step) { return leaks(*inputs, step, quick); }},
        {"imports.hostile", "damaged files and junk: an error or a sound scene, within the limits of memory and time",
         [=](const Step& step) { return hostile(*inputs, step); }},
    };
}

}  // namespace clarity::check
