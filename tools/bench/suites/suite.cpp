#include "tools/bench/suites/suite.hpp"

#include <algorithm>
#include <cstdlib>

#include "base/error.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/scenes/animations.hpp"
#include "view/settings/accel_choice.hpp"

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

// Scenes of a suite: a list of the catalogue, or one scene.
struct SceneChoice {
    enum class From { project, thesis, shared, views, zoo, shapes } from;
    const char* name = nullptr;  // nullptr: all of the list
    const char* sky = nullptr;   // a scene of the project, whose sky is added
    bool at_sizes = false;       // once at each size of the suite
};
using From = SceneChoice::From;

// Seconds that a suite may take.
struct TimeLimit {
    double suite_s, scene_s;
    static TimeLimit whole(double suite_s) { return {suite_s, 0}; }
    static TimeLimit each_scene(double scene_s) { return {0, scene_s}; }
    // scene_s: if the user names the scenes.
    static TimeLimit whole_or_each(double suite_s, double scene_s) { return {suite_s, scene_s}; }
};

class Planner {
 public:
    Planner(const BenchRequest& request, const SceneCatalog& catalog, const PluginRegistry& plugins)
        : request_(request), catalog_(catalog), plugins_(plugins) {}

    Suite plan() {
        for (const std::string& name : request_.suites) add(name);
        if (request_.suites.empty() && !request_.files.empty()) add("accel");
        if (request_.time_limit_s > 0) suite_.time_limit_s = request_.time_limit_s;
        keep_only();
        return std::move(suite_);
    }

    struct Row {
        const char* name;
        TimeLimit limit;
        std::vector<SceneChoice> scenes;
        void (Planner::*cases)(size_t scene);
        std::vector<uint64_t> sizes = {};  // triangles that scenes are split to
        bool unpacked = false;             // its own scenes must not be packed: ranks read the files themselves
    };
    static const std::vector<Row>& rows();

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
        for (const Row& row : rows())
            if (name == row.name) return add(row);
        throw Error(Exit::usage, "bench " + name + ": no such suite, and no such file; the suites are " + suite_list());
    }

    // Scenes named by the user replace the suite's own.
    void add(const Row& row) {
        row_ = &row;
        const size_t first = suite_.scenes.size();
        const bool own = request_.files.empty();
        const auto add_scenes = [&](uint64_t size) {
            for (const std::string& file : request_.files) add_scene(scene_of_file(file), size);
            for (const SceneChoice& choice : own ? row.scenes : std::vector<SceneChoice>())
                if (choice.at_sizes == (size > 0))
                    for (const BenchView& view : scenes_of(choice)) add_scene(view.scene, size > 0 ? size : view.subdivide_to);
        };
        if (own || row.sizes.empty()) add_scenes(0);
        for (const uint64_t size : row.sizes) {
            if (size > request_.max_triangles) {
                suite_.notes.push_back(size_name(size) + " triangles and more: beyond --max-triangles " +
                                       std::to_string(request_.max_triangles));
                break;
            }
            add_scenes(size);
        }
        const size_t end = suite_.scenes.size();
        const bool by_scene = row.limit.suite_s == 0 || (!own && row.limit.scene_s > 0);
        suite_.time_limit_s += by_scene ? row.limit.scene_s * double(end - first) : row.limit.suite_s;
        for (size_t scene = first; scene < end; ++scene) (this->*row.cases)(scene);
    }

    std::vector<BenchView> scenes_of(const SceneChoice& choice) const {
        std::vector<BenchView> views;
        for (BenchView& view : list_of(choice)) {
            // A list that is not there has one row, which says so.
            const bool is_other = choice.from != From::project && choice.name && view.scene.name != choice.name;
            if (is_other && (choice.from == From::views || view.scene.missing.empty())) continue;
            if (choice.sky && view.scene.missing.empty()) {
                const BenchScene sky = catalog_.project(choice.sky);
                view.scene.missing = sky.missing;
                view.scene.files.insert(view.scene.files.end(), sky.files.begin(), sky.files.end());
            }
            views.push_back(std::move(view));
        }
        return views;
    }
    std::vector<BenchView> list_of(const SceneChoice& choice) const {
        if (choice.from == From::views) return catalog_.views();
        std::vector<BenchView> views;
        for (BenchScene& scene : choice.from == From::project  ? std::vector<BenchScene>{catalog_.project(choice.name)}
                                 : choice.from == From::thesis ? catalog_.thesis()
                                 : choice.from == From::shared ? catalog_.shared()
                                 : choice.from == From::zoo    ? catalog_.zoo(request_.max_triangles)
                                                               : catalog_.shapes())
            views.push_back({std::move(scene), 0});
        return views;
    }

    // A scene that was not found becomes a note.
    void add_scene(BenchScene source, uint64_t subdivide_to) {
        if (row_->unpacked && request_.files.empty() && source.missing.empty() &&
            std::any_of(source.files.begin(), source.files.end(), ends_with_gz))
            source.missing = source.name + ": ranks do not read .gz; unpack it and name the file";
        if (!source.missing.empty()) {
            if (std::find(suite_.notes.begin(), suite_.notes.end(), source.missing) == suite_.notes.end())
                suite_.notes.push_back(source.missing);
            return;
        }
        if (subdivide_to > 0) source.name += "_" + size_name(subdivide_to);
        suite_.scenes.push_back({std::move(source), subdivide_to});
    }

    const std::string& name_of(size_t scene) const { return suite_.scenes[scene].source.name; }
    bool is_own(size_t scene, const char* name) const { return request_.files.empty() && name_of(scene) == name; }

    BenchCase& add_case(size_t scene, const std::string& what, const std::string& measure, std::vector<Variant> variants = {},
                        std::vector<std::string> qualities = {}) {
        BenchCase c;
        c.suite = row_->name;
        c.name = name_of(scene) + "/" + what;
        c.measure = measure;
        c.scene = scene;
        c.variants = std::move(variants);
        if (request_.baselines) c.baseline_qualities = std::move(qualities);
        suite_.cases.push_back(std::move(c));
        return suite_.cases.back();
    }
    void add_cases(size_t scene, std::initializer_list<const char*> measures, const std::vector<Variant>& variants,
                   const std::vector<std::string>& qualities = {}) {
        for (const std::string measure : measures)
            add_case(scene, measure, measure, variants, measure == "frame" ? std::vector<std::string>() : qualities);
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

    // Those asked for, or all but those that test every primitive: on large scenes they would take minutes.
    std::vector<Variant> every_tree() const {
        std::vector<Variant> variants = every_accel();
        if (!request_.accels.empty()) return variants;
        const auto tests_everything = [&](const Variant& variant) {
            const rt_plugin* plugin = plugins_.accel(variant.accel.substr(0, variant.accel.find(',')));
            return plugin && plugin->accel->ray_cost == RT_RAY_COST_LINEAR;
        };
        variants.erase(std::remove_if(variants.begin(), variants.end(), tests_everything), variants.end());
        return variants;
    }

    // Those asked for, or one.
    std::vector<Variant> asked_or(const std::string& accel) const {
        return request_.accels.empty() ? std::vector<Variant>{{accel, accel, {}, false}} : every_accel();
    }

    std::vector<Variant> best_on_gpus(size_t count) const {
        std::vector<Variant> variants;
        for (const rt_plugin* plugin : accels_by_merit(plugins_, DeviceKind::gpu))
            if (variants.size() < count) variants.push_back({plugin->id, plugin->id, {}, false});
        return variants;
    }

    // Sets what the user has not.
    void usual(Variant& variant, const char* key, const char* value) const {
        if (!sets(key)) variant.settings.emplace_back(key, value);
    }
    bool sets(const char* key) const {
        return std::any_of(request_.settings.begin(), request_.settings.end(),
                           [&](const auto& pair) { return pair.first == key; });
    }

    // Today's way and the thesis's, with a depth.
    void steps(size_t scene, int depth, bool with_then) {
        const std::string text = std::to_string(depth);
        std::vector<Variant> variants = {{"now", main_accel(), {{"depth", text}}, false}};
        if (with_then) variants.push_back(then_variant());
        if (with_then) variants.back().settings.emplace_back("depth", text);
        add_case(scene, text + (depth == 1 ? " step" : " steps"), "frame", variants);
    }

    // How many rays are dropped when each pixel has a ray array of fixed size.
    void dropped(size_t scene) {
        BenchCase& c = add_case(scene, "dropped", "dropped");
        c.timing = Timing::counted_only;
        for (const char* slots : {"1", "2", "4", "8"})
            c.variants.push_back({std::string("slots ") + slots, main_accel(), {{"ray_slots", slots}, {"depth", "4"}}, false});
    }

    void thesis(size_t scene) {
        if (is_own(scene, "spheres21") || is_own(scene, "aim_100k")) return steps(scene, 4, is_own(scene, "spheres21"));
        for (int depth = 1; depth <= 4; ++depth) steps(scene, depth, true);
        for (const char* kind : {"primary", "reflection"})
            add_case(scene, kind, kind, {{"now", main_accel(), {}, false}, then_variant()}).timing = Timing::counted_only;
        dropped(scene);
    }

    void packets(size_t scene) {
        BenchCase& c = add_case(scene, "4 steps", "frame");
        for (const char* lanes : {"1", "4", "8", "16"})
            for (const char* packet : {"1x1", "2x2", "4x4", "8x8", "16x16"}) {
                // A packet with fewer pixels than lanes would leave lanes idle. The ray arrays of 16x16 pixels do not fit into
                // a GPU's private memory.
                const int side = std::atoi(packet), count = std::atoi(lanes);
                if (side * side < count) continue;
                c.variants.push_back({std::string(packet) + ", lanes " + lanes,
                                      main_accel(),
                                      {{"packet", packet}, {"lanes", lanes}, {"depth", "4"}},
                                      count > 1 || side > 8});
            }
    }

    void accel(size_t scene) {
        add_cases(scene, {"build", "primary", "shadow", "reflection", "diffuse", "frame"}, every_accel(), kAllQualities);
        if (request_.suites.empty()) dropped(scene);
    }

    // Every structure on scenes that are hard in different ways.
    void zoo(size_t scene) { add_cases(scene, {"build", "primary", "shadow", "reflection", "diffuse"}, every_tree()); }

    // Shapes and meshes of them, each by itself.
    void shapes(size_t scene) { add_cases(scene, {"primary", "diffuse"}, asked_or("bvh2")); }

    void scale(size_t scene) { add_cases(scene, {"build", "primary", "shadow", "diffuse", "frame"}, every_tree(), {"medium"}); }

    // Memory and speed of models which are larger than the caches.
    void large(size_t scene) {
        add_cases(scene, {"build", "primary", "shadow", "diffuse", "frame"},
                  request_.accels.empty() ? best_on_gpus(2) : every_accel());
    }

    // SIMD performance of a CPU, compared with the fastest mode of the baselines.
    void cpu(size_t scene) {
        std::vector<Variant> variants = asked_or(cpu_accel());
        std::vector<std::string> like = {"medium"};  // each structure's own quality
        for (const Variant& variant : variants)
            if (const std::string quality = like_quality(variant.accel);
                std::find(like.begin(), like.end(), quality) == like.end())
                like.push_back(quality);
        add_cases(scene, {"build"}, variants, like);
        add_cases(scene, {"primary", "shadow", "diffuse"}, variants, {"medium", "high"});
        for (Variant& variant : variants) variant.settings.emplace_back("depth", "5");
        add_cases(scene, {"whitted"}, variants, {"medium", "high"});
    }

    // Without --accel, the default structure of the devices is used.
    std::vector<Variant> pictures(const char* size) const {
        std::vector<Variant> variants = asked_or("");
        for (Variant& variant : variants) {
            usual(variant, "size", size);
            usual(variant, "spp", "16");
        }
        return variants;
    }

    // One picture by one device, by two devices, and so on.
    void devices(size_t scene) {
        const std::vector<Variant> variants = pictures("3840x2160");
        add_case(scene, "picture", "picture", variants);
        BenchCase& moving = add_case(scene, "moving", "moving");
        for (Variant variant : variants)
            for (const bool overlapped : {false, true}) {
                variant.label = (variant.accel.empty() ? "" : variant.accel + ", ") +
                                std::string(overlapped ? "copied beside the next" : "one by one");
                variant.overlapped = overlapped;
                moving.variants.push_back(variant);
            }
    }

    // One picture by the ranks that mpirun starts.
    void mpi(size_t scene) { add_case(scene, "ranks", "ranks", pictures("1920x1080")); }

    // Paths of light: errors over samples and seconds with either sampler, and the start of a program that nothing has
    // compiled.
    void light(size_t scene) {
        std::vector<Variant> variants;
        for (const Variant& structure : asked_or(""))
            for (const char* sampler : {"independent", "sobol"}) {
                Variant variant = structure;
                const bool is_asked = sets("sampler");
                const std::string what = is_asked ? "path" : sampler;
                variant.label = variant.accel.empty() ? what : variant.accel + ", " + what;
                variant.settings.emplace_back("tracer", "path");
                usual(variant, "sampler", sampler);
                usual(variant, "size", "256x256");
                usual(variant, "spp", "64");
                usual(variant, "depth", "8");
                variants.push_back(variant);
                if (is_asked) break;
            }
        add_case(scene, "light", "light", variants);
        if (request_.files.empty() && !is_own(scene, "showpiece_sky")) return;
        BenchCase& start = add_case(scene, "start", "start");
        start.timing = Timing::counted_only;
        for (const char* tracer : {"iterative", "path"})
            for (const bool cold : {true, false}) {
                start.variants.push_back({std::string(tracer) + (cold ? ", cold" : ", warm"),
                                          main_accel(),
                                          {{"tracer", tracer}, {"size", "64x64"}, {"spp", "1"}}});
                start.variants.back().cold = cold;
            }
    }

    // Models whose vertices all move. Structures that do not refit say so in their rows.
    void moving(size_t scene) {
        for (const std::string& motion : motion_names()) {
            moving_case(scene, motion, "refit", motion + " refit", {"", ", on the device"}, {"refit"});
            moving_case(scene, motion, "rebuild", motion + " rebuild", {""}, {"low", "medium"});
            for (const char* measure : {"primary", "diffuse"})
                moving_case(scene, motion, measure, motion + " " + measure, {", built", ", refitted"});
            if (motion != "wave") continue;  // the motion that devices compute
            moving_case(scene, motion, "frame", motion + " frame", {", built", ", refitted"});
            moving_case(scene, motion, "object", "one object", {", still", ", one object moves"});
            if (!request_.files.empty())
                moving_case(scene, motion, "clip", "its own clip", {", built", ", refitted", ", refitted, vertices sent"});
        }
    }

    // ways: what is appended to the label of each structure. Of rays and pictures, all but the first are of refitted
    // structures.
    void moving_case(size_t scene, const std::string& motion, const std::string& measure, const std::string& name,
                     const std::vector<std::string>& ways, const std::vector<std::string>& qualities = {}) {
        BenchCase& c = add_case(scene, name, measure, {}, qualities);
        c.motion = motion;
        for (const Variant& tree : every_tree())
            for (size_t way = 0; way < ways.size(); ++way) {
                Variant variant = tree;
                variant.label += ways[way];
                if (measure == "refit") variant.on_device = way > 0;
                if (measure == "frame" || measure == "object" || measure == "clip") variant.on_device = true;
                variant.refitted = measure != "refit" && way > 0;
                variant.sends_vertices = way > 1;
                c.variants.push_back(variant);
            }
    }

    // Animations, by fixed rules for refits and builds and by that of the window. A file plays its own clip besides.
    void policy(size_t scene) {
        Variant variant = {main_accel(), main_accel(), {}, false};
        usual(variant, "size", "320x240");
        std::vector<std::string> animations = animation_names();
        if (!request_.files.empty()) animations.push_back(kOwnClip);
        for (const std::string& animation : animations) add_case(scene, animation, "play", {variant}).motion = animation;
    }

    void quick(size_t scene) {
        if (!is_own(scene, "skull")) steps(scene, 4, true);
        if (request_.files.empty() && !is_own(scene, "skull")) return;
        add_cases(scene, {"build", "primary", "shadow", "diffuse"}, {{main_accel(), main_accel(), {}, false}}, {"medium"});
    }

    const BenchRequest& request_;
    const SceneCatalog& catalog_;
    const PluginRegistry& plugins_;
    Suite suite_;
    const Row* row_ = nullptr;  // the suite that is being added
};

const std::vector<Planner::Row>& Planner::rows() {
    static const std::vector<Row> rows = {
        {"thesis",
         TimeLimit::whole(480),
         {{From::thesis}, {From::project, "spheres21"}, {From::project, "thesis/aim_100k"}},
         &Planner::thesis},
        {"packets", TimeLimit::whole(900), {{From::thesis}}, &Planner::packets},
        {"accel",
         TimeLimit::whole_or_each(1500, 120),
         {{From::thesis}, {From::project, "thesis/aim_100k"}, {From::shared}},
         &Planner::accel},
        {"scale",
         TimeLimit::whole(900),
         {{From::project, "models/spot", nullptr, true}},
         &Planner::scale,
         {1'000, 3'000, 10'000, 30'000, 100'000, 300'000, 1'000'000, 3'000'000, 10'000'000}},
        {"large",
         TimeLimit::whole(1200),
         {{From::shared, "dragon_871k"}, {From::views, "skull near", nullptr, true}},
         &Planner::large,
         {1'000'000, 10'000'000, 100'000'000}},
        {"cpu", TimeLimit::whole_or_each(1800, 150), {{From::shared}, {From::views}}, &Planner::cpu},
        {"devices", TimeLimit::each_scene(90), {{From::project, "thesis/aim_100k"}, {From::shared}}, &Planner::devices},
        {"mpi", TimeLimit::each_scene(120), {{From::project, "thesis/aim_100k"}, {From::shared}}, &Planner::mpi, {}, true},
        {"light",
         TimeLimit::each_scene(300),
         {{From::project, "cornell"},
          {From::project, "spheres_sky"},
          {From::project, "veach"},
          {From::project, "showpiece_sky"},
          {From::shared, "salle_de_bain", "plaster_sky"}},
         &Planner::light},
        {"moving", TimeLimit::each_scene(240), {{From::project, "thesis/aim_100k"}, {From::shared}}, &Planner::moving},
        {"policy", TimeLimit::each_scene(600), {{From::project, "thesis/models/skull"}}, &Planner::policy},
        {"zoo", TimeLimit::whole_or_each(3600, 450), {{From::zoo}}, &Planner::zoo},
        {"shapes", TimeLimit::whole_or_each(900, 60), {{From::shapes}}, &Planner::shapes},
        {"quick",
         TimeLimit::whole(55),
         {{From::project, "thesis/2_two_spheres"},
          {From::project, "thesis/6_2406_triangles"},
          {From::project, "thesis/models/skull"}},
         &Planner::quick}};
    return rows;
}

}  // namespace

const std::vector<std::string>& suite_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const Planner::Row& row : Planner::rows()) all.emplace_back(row.name);
        return all;
    }();
    return names;
}

std::string suite_list() {
    std::string list;
    for (const std::string& suite : suite_names()) list += (list.empty() ? "" : ", ") + suite;
    return list;
}

Suite make_suite(const BenchRequest& request, const SceneCatalog& catalog, const PluginRegistry& plugins) {
    return Planner(request, catalog, plugins).plan();
}

}  // namespace clarity::bench
