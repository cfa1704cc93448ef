#include "bench/suites/suite.hpp"

#include <algorithm>
#include <cstdlib>

#include "base/error.hpp"
#include "bench/baselines/speedup.hpp"
#include "bench/motion/animations.hpp"
#include "bench/motion/motions.hpp"
#include "render/settings/accel_choice.hpp"

namespace clarity::bench {
namespace {

const std::vector<std::string> kAllQualities = {"low", "medium", "high"};

// The thesis's own design: bounding spheres split by count, one tree per mesh without a top level, analytic spheres tested one
// by one, scalar work-items of 4x4 pixels.
Variant then_variant() {
    return {"then", "spheres,lone_spheres=true", {{"lanes", "1"}, {"packet", "4x4"}}, false};
}

// 30 000 -> "30k", 10 000 000 -> "10M".
std::string size_name(uint64_t count) {
    return count >= 1'000'000 ? std::to_string(count / 1'000'000) + "M" : std::to_string(count / 1'000) + "k";
}

bool ends_with_gz(const std::string& file) {
    return file.size() > 3 && file.compare(file.size() - 3, 3, ".gz") == 0;
}

class Planner {
 public:
    Planner(const BenchRequest& request, const SceneCatalog& catalog, const PluginRegistry& plugins)
        : request_(request), catalog_(catalog), plugins_(plugins) {}

    Suite plan() {
        for (const std::string& name : request_.suites) add(name);
        if (request_.suites.empty() && !request_.files.empty()) accel("accel", chosen_or({}), true);
        if (request_.time_limit_s > 0) suite_.time_limit_s = request_.time_limit_s;
        keep_only();
        return std::move(suite_);
    }

 private:
    // Keeps the cases which --only names. All scenes stay in the list, because cases refer to them by index; a scene without a
    // case is never loaded.
    void keep_only() {
        if (request_.only.empty()) return;
        const auto wanted = [&](const BenchCase& c) {
            return std::any_of(request_.only.begin(), request_.only.end(),
                               [&](const std::string& text) { return c.name.find(text) != std::string::npos; });
        };
        std::vector<BenchCase>& cases = suite_.cases;
        cases.erase(std::remove_if(cases.begin(), cases.end(), [&](const BenchCase& c) { return !wanted(c); }), cases.end());
        if (cases.empty())
            throw Error(Exit::usage, "--only " + request_.only.front() + ": no case has it in its name; --list shows them");
    }

    void add(const std::string& name) {
        if (name == "thesis") return thesis();
        if (name == "packets") return packets();
        if (name == "accel") return accel_suite();
        if (name == "scale") return scale();
        if (name == "large") return large();
        if (name == "cpu") return cpu();
        if (name == "devices") return devices();
        if (name == "mpi") return mpi();
        if (name == "moving") return moving();
        if (name == "policy") return policy();
        if (name == "quick") return quick();
        std::string known;
        for (const std::string& suite : suite_names()) known += (known.empty() ? "" : ", ") + suite;
        throw Error(Exit::usage, "bench " + name + ": no such suite, and no such file; the suites are " + known);
    }

    // Adds the scenes named by the user, or else those of the suite's own scenes which were found. Notes the missing ones.
    // Returns indices into Suite::scenes.
    std::vector<size_t> chosen_or(const std::vector<BenchScene>& own, uint64_t subdivide_to = 0) {
        std::vector<BenchScene> sources = own;
        if (!request_.files.empty()) {
            sources.clear();
            for (const std::string& file : request_.files) sources.push_back(scene_of_file(file));
        }
        std::vector<size_t> added;
        for (const BenchScene& source : sources) {
            if (!source.missing.empty()) {
                if (std::find(suite_.notes.begin(), suite_.notes.end(), source.missing) == suite_.notes.end())
                    suite_.notes.push_back(source.missing);
                continue;
            }
            suite_.scenes.push_back({source, subdivide_to});
            if (subdivide_to > 0) suite_.scenes.back().source.name += "_" + size_name(subdivide_to);
            added.push_back(suite_.scenes.size() - 1);
        }
        return added;
    }

    const std::string& name_of(size_t scene) const { return suite_.scenes[scene].source.name; }

    BenchCase& add_case(const std::string& suite, size_t scene, const std::string& what, const std::string& measure) {
        BenchCase c;
        c.suite = suite;
        c.name = name_of(scene) + "/" + what;
        c.measure = measure;
        c.scene = scene;
        suite_.cases.push_back(c);
        return suite_.cases.back();
    }

    // The structure for suites which do not compare structures.
    std::string main_accel() const { return request_.accels.empty() ? cpu_accel() : request_.accels.front(); }
    std::string cpu_accel() const { return best_accel(plugins_, DeviceKind::cpu).id; }

    std::vector<Variant> every_accel() const {
        std::vector<Variant> variants;
        if (!request_.accels.empty())
            for (const std::string& text : request_.accels) variants.push_back({text, text, {}, false});
        else
            for (const rt_plugin* plugin : plugins_.accels()) variants.push_back({plugin->id, plugin->id, {}, false});
        return variants;
    }

    std::vector<Variant> best_on_gpus(size_t count) const {
        std::vector<Variant> variants;
        for (const rt_plugin* plugin : accels_by_merit(plugins_, DeviceKind::gpu))
            if (variants.size() < count) variants.push_back({plugin->id, plugin->id, {}, false});
        return variants;
    }

    // An unknown structure does not: its rows say that it is unknown.
    bool tests_everything(const Variant& variant) const {
        const rt_plugin* plugin = plugins_.accel(variant.accel.substr(0, variant.accel.find(',')));
        return plugin && plugin->accel->ray_cost == RT_RAY_COST_LINEAR;
    }

    void limit(double seconds) { suite_.time_limit_s += seconds; }

    void thesis() {
        limit(480);
        const auto step_case = [&](size_t scene, int steps, bool naive) {
            const std::string text = std::to_string(steps);
            BenchCase& c = add_case("thesis", scene, text + (steps == 1 ? " step" : " steps"), "frame");
            c.variants = {{"now", main_accel(), {{"depth", text}}, false}};
            if (naive) c.variants.push_back(then_variant());
            c.variants.back().settings.emplace_back("depth", text);
        };
        for (const size_t scene : chosen_or(catalog_.thesis())) {
            for (int steps = 1; steps <= 4; ++steps) step_case(scene, steps, true);
            analysis_cases("thesis", scene);
        }
        if (!request_.files.empty()) return;
        for (const size_t scene : chosen_or({catalog_.project("spheres21")})) step_case(scene, 4, true);
        for (const size_t scene : chosen_or({catalog_.project("thesis/aim_100k")})) step_case(scene, 4, false);
    }

    void analysis_cases(const std::string& suite, size_t scene) {
        for (const char* kind : {"primary", "reflection"}) {
            BenchCase& c = add_case(suite, scene, kind, kind);
            c.variants = {{"now", main_accel(), {}, false}, then_variant()};
            c.timing = Timing::counted_only;
        }
        dropped(suite, scene);
    }

    // How many rays are dropped when each pixel has a ray array of fixed size.
    void dropped(const std::string& suite, size_t scene) {
        BenchCase& c = add_case(suite, scene, "dropped", "dropped");
        c.timing = Timing::counted_only;
        for (const char* slots : {"1", "2", "4", "8"})
            c.variants.push_back({std::string("slots ") + slots, main_accel(), {{"ray_slots", slots}, {"depth", "4"}}, false});
    }

    void packets() {
        limit(900);
        for (const size_t scene : chosen_or(catalog_.thesis())) {
            BenchCase& c = add_case("packets", scene, "4 steps", "frame");
            for (const char* lanes : {"1", "4", "8", "16"})
                for (const char* packet : {"1x1", "2x2", "4x4", "8x8", "16x16"}) {
                    // A packet with fewer pixels than lanes would leave lanes idle. The ray arrays of 16x16 pixels do not fit
                    // into a GPU's private memory.
                    const int side = std::atoi(packet), count = std::atoi(lanes);
                    if (side * side < count) continue;
                    c.variants.push_back({std::string(packet) + ", lanes " + lanes,
                                          main_accel(),
                                          {{"packet", packet}, {"lanes", lanes}, {"depth", "4"}},
                                          count > 1 || side > 8});
                }
        }
    }

    void accel(const std::string& suite, const std::vector<size_t>& scenes, bool with_dropped) {
        if (limit_of_accel_added_++ == 0) limit(request_.files.empty() ? 1500 : 120.0 * double(request_.files.size()));
        for (const size_t scene : scenes) {
            for (const char* measure : {"build", "primary", "shadow", "reflection", "diffuse", "frame"}) {
                BenchCase& c = add_case(suite, scene, measure, measure);
                c.variants = every_accel();
                if (request_.baselines && c.measure != "frame") c.baseline_qualities = kAllQualities;
            }
            if (with_dropped) dropped(suite, scene);
        }
    }

    void accel_suite() {
        std::vector<BenchScene> own = catalog_.thesis();
        own.push_back(catalog_.project("thesis/aim_100k"));
        for (const BenchScene& scene : catalog_.shared()) own.push_back(scene);
        accel("accel", chosen_or(own), false);
    }

    bool beyond_limit(uint64_t size) {
        if (size <= request_.max_triangles) return false;
        suite_.notes.push_back(size_name(size) + " triangles and more: beyond --max-triangles " +
                               std::to_string(request_.max_triangles));
        return true;
    }

    void scale() {
        limit(900);
        const std::vector<BenchScene> own = {catalog_.project("models/spot")};
        for (const uint64_t size : {1'000, 3'000, 10'000, 30'000, 100'000, 300'000, 1'000'000, 3'000'000, 10'000'000}) {
            if (beyond_limit(size)) break;
            for (const size_t scene : chosen_or(own, size))
                for (const char* measure : {"build", "primary", "shadow", "diffuse", "frame"}) {
                    BenchCase& c = add_case("scale", scene, measure, measure);
                    for (const Variant& variant : every_accel())
                        if (!tests_everything(variant)) c.variants.push_back(variant);
                    if (request_.baselines && c.measure != "frame") c.baseline_qualities = {"medium"};
                }
        }
    }

    // Memory and speed of models which are larger than the caches. Structures: the two best of GPUs, or those asked for.
    void large() {
        limit(1200);
        std::vector<Variant> variants = every_accel();
        if (request_.accels.empty()) variants = best_on_gpus(2);
        std::vector<size_t> scenes;
        if (request_.files.empty()) {
            std::vector<BenchScene> whole = catalog_.shared();
            whole.erase(std::remove_if(whole.begin(), whole.end(),
                                       [](const BenchScene& s) { return s.name != "dragon_871k" && s.missing.empty(); }),
                        whole.end());
            scenes = chosen_or(whole);
        }
        std::vector<BenchScene> grown;
        for (const BenchView& view : catalog_.views())
            if (view.scene.name == "skull near") grown.push_back(view.scene);
        for (const uint64_t size : {1'000'000, 10'000'000, 100'000'000}) {
            if (beyond_limit(size)) break;
            for (const size_t scene : chosen_or(grown, size)) scenes.push_back(scene);
        }
        for (const size_t scene : scenes)
            for (const char* measure : {"build", "primary", "shadow", "diffuse", "frame"})
                add_case("large", scene, measure, measure).variants = variants;
    }

    // SIMD performance of a CPU, compared with the fastest mode of the baselines.
    void cpu() {
        limit(request_.files.empty() ? 1800 : 150.0 * double(request_.files.size()));
        std::vector<size_t> scenes = chosen_or(catalog_.shared());
        if (request_.files.empty())
            for (const BenchView& view : catalog_.views())
                for (const size_t scene : chosen_or({view.scene}, view.subdivide_to)) scenes.push_back(scene);
        for (const size_t scene : scenes)
            for (const char* measure : {"build", "primary", "shadow", "diffuse", "whitted"}) {
                BenchCase& c = add_case("cpu", scene, measure, measure);
                c.variants = {{cpu_accel(), cpu_accel(), {}, false}};
                if (!request_.accels.empty()) c.variants = every_accel();
                if (c.measure == "whitted")
                    for (Variant& variant : c.variants) variant.settings.emplace_back("depth", "5");
                if (!request_.baselines) continue;
                std::vector<std::string>& qualities = c.baseline_qualities;
                qualities = {"medium"};
                if (c.measure != "build") {
                    qualities.push_back("high");
                    continue;
                }
                for (const Variant& variant : c.variants)
                    if (const std::string like = like_quality(variant.accel);
                        std::find(qualities.begin(), qualities.end(), like) == qualities.end())
                        qualities.push_back(like);
            }
    }

    // Sets what the user has not.
    void usual(Variant& variant, const char* key, const char* value) const {
        const auto is_key = [&](const auto& pair) { return pair.first == key; };
        if (std::none_of(request_.settings.begin(), request_.settings.end(), is_key)) variant.settings.emplace_back(key, value);
    }

    // One picture by one device, by two devices, and so on. Without --accel, the default structure of the devices is used.
    void devices() {
        std::vector<BenchScene> own = {catalog_.project("thesis/aim_100k")};
        for (const BenchScene& scene : catalog_.shared()) own.push_back(scene);
        const std::vector<size_t> scenes = chosen_or(own);
        limit(90.0 * double(scenes.size()));
        for (const size_t scene : scenes) {
            BenchCase& c = add_case("devices", scene, "picture", "picture");
            c.variants = {{"", "", {}, false}};
            if (!request_.accels.empty()) c.variants = every_accel();
            for (Variant& variant : c.variants) {
                usual(variant, "size", "3840x2160");
                usual(variant, "spp", "16");
            }
            const std::vector<Variant> variants = c.variants;
            BenchCase& moving = add_case("devices", scene, "moving", "moving");
            for (Variant variant : variants)
                for (const bool overlapped : {false, true}) {
                    variant.label = (variant.accel.empty() ? "" : variant.accel + ", ") +
                                    std::string(overlapped ? "copied beside the next" : "one by one");
                    variant.overlapped = overlapped;
                    moving.variants.push_back(variant);
                }
        }
    }

    // One picture by the ranks that mpirun starts. They read the files themselves, which must therefore not be packed.
    void mpi() {
        std::vector<BenchScene> own = {catalog_.project("thesis/aim_100k")};
        for (const BenchScene& scene : catalog_.shared()) own.push_back(scene);
        for (BenchScene& scene : own)
            for (const std::string& file : scene.files)
                if (scene.missing.empty() && ends_with_gz(file))
                    scene.missing = scene.name + ": ranks do not read .gz; unpack it and name the file";
        const std::vector<size_t> scenes = chosen_or(own);
        limit(120.0 * double(scenes.size()));
        for (const size_t scene : scenes) {
            BenchCase& c = add_case("mpi", scene, "ranks", "ranks");
            c.variants = {{"", "", {}, false}};
            if (!request_.accels.empty()) c.variants = every_accel();
            for (Variant& variant : c.variants) {
                usual(variant, "size", "1920x1080");
                usual(variant, "spp", "16");
            }
        }
    }

    // Models whose vertices all move. Structures that do not refit say so in their rows.
    void moving() {
        std::vector<BenchScene> own = {catalog_.project("thesis/aim_100k")};
        for (const BenchScene& scene : catalog_.shared()) own.push_back(scene);
        const std::vector<size_t> scenes = chosen_or(own);
        limit(240.0 * double(scenes.size()));
        std::vector<Variant> variants;
        for (const Variant& variant : every_accel())
            if (!tests_everything(variant)) variants.push_back(variant);
        for (const size_t scene : scenes)
            for (const std::string& motion : motion_names())
                for (const char* measure : {"refit", "rebuild", "primary", "diffuse", "frame", "object", "clip"}) {
                    const std::string what = measure;
                    const bool frames = what == "frame" || what == "object" || what == "clip";
                    if (frames && motion != "wave") continue;  // the motion that devices compute
                    if (what == "clip" && request_.files.empty()) continue;
                    const std::string name = what == "object" ? "one object"
                                             : what == "clip" ? "its own clip"
                                                              : motion + " " + what;
                    BenchCase& c = add_case("moving", scene, name, measure);
                    c.motion = motion;
                    const bool rays = c.measure != "refit" && c.measure != "rebuild";
                    for (Variant variant : variants) {
                        if (!rays) {
                            c.variants.push_back(variant);
                            if (c.measure != "refit") continue;
                            variant.label += ", on the device";
                            variant.on_device = true;
                            c.variants.push_back(variant);
                            continue;
                        }
                        const std::string name = variant.label;
                        variant.on_device = frames;
                        variant.label = name + (what == "object" ? ", still" : ", built");
                        c.variants.push_back(variant);
                        variant.label = name + (what == "object" ? ", one object moves" : ", refitted");
                        variant.refitted = true;
                        c.variants.push_back(variant);
                        if (what != "clip") continue;
                        variant.label += ", vertices sent";
                        variant.sends_vertices = true;
                        c.variants.push_back(variant);
                    }
                    if (request_.baselines && c.measure == "refit") c.baseline_qualities = {"refit"};
                    if (request_.baselines && c.measure == "rebuild") c.baseline_qualities = {"low", "medium"};
                }
    }

    // Animations, by fixed rules for refits and builds and by that of the window. A file plays its own clip besides.
    void policy() {
        const std::vector<size_t> scenes = chosen_or({catalog_.project("thesis/models/skull")});
        limit(600.0 * double(scenes.size()));
        Variant variant = {main_accel(), main_accel(), {}, false};
        const auto is_size = [](const auto& pair) { return pair.first == "size"; };
        if (std::none_of(request_.settings.begin(), request_.settings.end(), is_size))
            variant.settings.emplace_back("size", "320x240");
        for (const size_t scene : scenes) {
            std::vector<std::string> animations = animation_names();
            if (!request_.files.empty()) animations.push_back(kOwnClip);
            for (const std::string& animation : animations) {
                BenchCase& c = add_case("policy", scene, animation, "play");
                c.motion = animation;
                c.variants = {variant};
            }
        }
    }

    void quick() {
        limit(55);
        const auto frame_case = [&](size_t scene) {
            BenchCase& c = add_case("quick", scene, "4 steps", "frame");
            c.variants = {{"now", main_accel(), {{"depth", "4"}}, false}, then_variant()};
            c.variants.back().settings.emplace_back("depth", "4");
        };
        const auto ray_cases = [&](size_t scene) {
            for (const char* kind : {"build", "primary", "shadow", "diffuse"}) {
                BenchCase& c = add_case("quick", scene, kind, kind);
                c.variants = {{main_accel(), main_accel(), {}, false}};
                if (request_.baselines) c.baseline_qualities = {"medium"};
            }
        };
        if (!request_.files.empty()) {
            for (const size_t scene : chosen_or({})) {
                frame_case(scene);
                ray_cases(scene);
            }
            return;
        }
        const std::vector<BenchScene> small = {catalog_.project("thesis/2_two_spheres"),
                                               catalog_.project("thesis/6_2406_triangles")};
        for (const size_t scene : chosen_or(small)) frame_case(scene);
        for (const size_t scene : chosen_or({catalog_.project("thesis/models/skull")})) ray_cases(scene);
    }

    const BenchRequest& request_;
    const SceneCatalog& catalog_;
    const PluginRegistry& plugins_;
    Suite suite_;
    int limit_of_accel_added_ = 0;
};

}  // namespace

const std::vector<std::string>& suite_names() {
    static const std::vector<std::string> names = {"thesis",  "packets", "accel",  "scale",  "large", "cpu",
                                                   "devices", "mpi",     "moving", "policy", "quick"};
    return names;
}

Suite make_suite(const BenchRequest& request, const SceneCatalog& catalog, const PluginRegistry& plugins) {
    return Planner(request, catalog, plugins).plan();
}

}  // namespace clarity::bench
