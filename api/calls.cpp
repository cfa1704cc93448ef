// calls.cpp -- the functions of clarity.h.
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>
#include <utility>

#include "api/clarity.h"
#include "api/handles.hpp"
#include "api/library.hpp"
#include "api/positions.hpp"
#include "api/rows.hpp"
#include "base/digest.hpp"
#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/progress.hpp"
#include "import/import.hpp"
#include "import/sink/world_origin.hpp"
#include "plugin/registry.hpp"
#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"
#include "scene/scene_json.hpp"

namespace clarity::api {
namespace {

// Progress of a call, told to the caller's function, and the caller's cancel.

class Watched : public Progress {
 public:
    explicit Watched(const clarity_watch& watch) : watch_(watch), goes_on_(goes_on_after_end()) {}
    void stage(const std::string& text) override {
        const std::lock_guard<std::mutex> lock(mutex_);
        stage_ = text;
        tell(0);
    }
    // Work reports as often as it likes; the caller hears of twenty a second.
    bool report(float fraction) override {
        if (const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock); lock && now_s() - told_s_ > 0.05) tell(fraction);
        return !cancelled();
    }
    bool cancelled() const override {
        return Progress::cancelled() || (watch_.cancel && *watch_.cancel != 0) || (has_ended() && !goes_on_);
    }

 private:
    void tell(float fraction) {
        told_s_ = now_s();
        if (!watch_.progress) return;
        const InCallersFunction calling;
        if (watch_.progress(watch_.user, stage_.c_str(), fraction) == 0) cancel();
    }
    const clarity_watch watch_;
    const bool goes_on_;  // when the library has ended
    std::mutex mutex_;    // one call at a time
    std::string stage_;
    double told_s_ = 0;
};

// A scene of the caller's arrays.

// Numbers of primitives are ints in kernels.
constexpr uint64_t kMost = std::numeric_limits<int32_t>::max();

// Rounds positions after the origin is subtracted that suits their box.
SharedArray<float> rounded(const double* positions, size_t numbers, std::array<double, 3>& origin) {
    import::WorldBox box;
    bool has_digits = false;
    for (size_t i = 0; i + 2 < numbers; i += 3) box.add({positions[i], positions[i + 1], positions[i + 2]});
    for (size_t i = 0; i < numbers && !has_digits; ++i) has_digits = positions[i] != double(float(positions[i]));
    if (box.is_far(has_digits ? import::kFarWithDigits : import::kFar)) origin = import::origin_of(box);
    std::vector<float> floats(numbers);
    for (size_t i = 0; i < numbers; ++i) floats[i] = static_cast<float>(positions[i] - origin[i % 3]);
    return floats;
}

// The scene borrows the arrays, but positions of type CLARITY_FLOAT64. Throws Error(usage) for arrays that are no mesh.
Scene scene_of_mesh(const PluginRegistry& plugins, const clarity_mesh& mesh) {
    const auto refuse = [](const std::string& why) { throw Error(Exit::usage, "the mesh of arrays " + why); };
    if (mesh.vertex_count > kMost || mesh.triangle_count > kMost)
        refuse("has more than 2^31 - 1 vertices or triangles: divide it");
    if ((!mesh.positions && mesh.vertex_count > 0) || (!mesh.triangles && mesh.triangle_count > 0))
        refuse("has a null pointer");
    if (mesh.type != CLARITY_FLOAT32 && mesh.type != CLARITY_FLOAT64)
        refuse("has positions of the unknown type " + std::to_string(mesh.type));
    Scene scene;
    const size_t numbers = 3 * mesh.vertex_count;
    if (mesh.type == CLARITY_FLOAT64)
        scene.positions = rounded(static_cast<const double*>(mesh.positions), numbers, scene.origin);
    else
        scene.positions = SharedArray<float>::borrow(nullptr, static_cast<const float*>(mesh.positions), numbers);
    if (const Problem why = problem_of_positions(scene.positions.data(), numbers))
        refuse("has vertices that it cannot have: " + why.text());
    scene.triangles = SharedArray<rt_u32>::borrow(nullptr, mesh.triangles, 3 * mesh.triangle_count);
    scene.triangle_materials.assign(mesh.triangle_count, 0);
    Mesh whole;
    whole.name = "mesh";
    whole.vertex_count = scene.vertex_count();
    whole.triangle_count = whole.polygon_count = scene.triangle_count();
    scene.meshes.push_back(whole);
    scene.instances.emplace_back();
    scene.instances.back().name = whole.name;
    scene.materials.push_back({"default", default_material()});
    if (const Problem why = import::complete_scene(plugins, scene)) refuse(why.text());
    return scene;
}

Watched watched(const clarity_watch* watch) {
    return Watched(watch ? copy_of(watch, "clarity_watch") : clarity_watch{});
}

clarity_scene* new_scene(Scene scene, const std::vector<std::string>& files) {
    auto made = std::make_unique<clarity_scene>();
    made->of_arrays = files.empty();
    made->imported = std::make_shared<const Scene>(std::move(scene));
    made->placed =
        made->imported->edits.empty() ? made->imported : std::make_shared<const Scene>(with_scene_edits(*made->imported));
    const auto json = scene_json(*made->placed, clips(*made->placed), files);
    made->info = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);  // names in files may not be UTF-8
    return made.release();
}

}  // namespace
}  // namespace clarity::api

using namespace clarity;
using namespace clarity::api;

#define CLARITY_EXPORT __attribute__((visibility("default")))

CLARITY_EXPORT const char* clarity_version(void) {
    return CLARITY_VERSION;
}

CLARITY_EXPORT const char* clarity_header_digest(void) {
    return CLARITY_HEADER_DIGEST;
}

CLARITY_EXPORT const char* clarity_error_text(void) {
    return error_text().c_str();
}

CLARITY_EXPORT const char* clarity_error_details(void) {
    return error_details().c_str();
}

CLARITY_EXPORT int32_t clarity_set_program(const char* path) {
    return run_light_call([&] { set_program(&not_null(path, "path")); });
}

CLARITY_EXPORT int32_t clarity_set_log(void (*log)(void*, int32_t, const char*), void* user) {
    return run_light_call([&] { set_log(log, user); });
}

CLARITY_EXPORT int32_t clarity_digest(const void* bytes, uint64_t count, char digest[33]) {
    return run_call([&] {
        char& to = not_null(digest, "digest");
        if (count > 0) not_null(static_cast<const char*>(bytes), "bytes");
        digest_of_bytes(bytes, count).copy(&to, 32);
        digest[32] = '\0';
    });
}

CLARITY_EXPORT int32_t clarity_end(void) {
    return run_light_call([] { end_library(); });
}

CLARITY_EXPORT int32_t clarity_scene_load(const char* const* files, uint64_t count, const clarity_watch* watch,
                                          clarity_scene** scene) {
    return run_call([&] {
        clarity_scene*& result = not_null(scene, "scene");
        std::vector<std::string> names;
        for (uint64_t i = 0; i < count; ++i) names.emplace_back(&not_null((&not_null(files, "files"))[i], "files[i]"));
        Watched progress = watched(watch);
        import::ImportOptions options;
        options.log_warnings = false;  // they are in the scene's info
        result = new_scene(import::import_scene(plugins(), names, options, progress), names);
    });
}

CLARITY_EXPORT int32_t clarity_scene_from_mesh(const clarity_mesh* mesh, const clarity_watch* watch, clarity_scene** scene) {
    return run_call([&] {
        clarity_scene*& result = not_null(scene, "scene");
        Watched progress = watched(watch);
        progress.stage("checking the mesh");
        if (progress.cancelled()) throw Cancelled();
        result = new_scene(scene_of_mesh(plugins(), copy_of(mesh, "clarity_mesh")), {});
    });
}

CLARITY_EXPORT void clarity_scene_free(clarity_scene* scene) {
    run_free([&] { delete scene; });
}

CLARITY_EXPORT int32_t clarity_scene_info(const clarity_scene* scene, const char** json) {
    return run_call([&] { not_null(json, "json") = not_null(scene, "scene").info.c_str(); });
}

CLARITY_EXPORT int32_t clarity_scene_bounds(const clarity_scene* scene, double lo[3], double hi[3]) {
    return run_call([&] {
        const Scene& placed = *not_null(scene, "scene").placed;
        double* const ends[] = {&not_null(lo, "lo"), &not_null(hi, "hi")};
        const Bounds bounds = placed.bounds();
        constexpr double kFar = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k) {
            ends[0][k] = bounds.empty ? kFar : placed.origin[k] + bounds.min[k];
            ends[1][k] = bounds.empty ? -kFar : placed.origin[k] + bounds.max[k];
        }
    });
}

CLARITY_EXPORT int32_t clarity_tracer_new(const clarity_scene* scene, const clarity_options* options,
                                          const clarity_watch* watch, clarity_tracer** tracer) {
    return run_call([&] {
        clarity_tracer*& result = not_null(tracer, "tracer");
        const clarity_options chosen = options ? copy_of(options, "clarity_options") : clarity_options{};
        Watched progress = watched(watch);
        result = new clarity_tracer(not_null(scene, "scene"), chosen, progress);
    });
}

CLARITY_EXPORT void clarity_tracer_free(clarity_tracer* tracer) {
    run_free([&] { delete tracer; });
}

CLARITY_EXPORT int32_t clarity_tracer_info(clarity_tracer* tracer, const char** json) {
    return run_call([&] { not_null(json, "json") = not_null(tracer, "tracer").info(); });
}

CLARITY_EXPORT int32_t clarity_closest(clarity_tracer* tracer, const clarity_rays* rays, const clarity_hits* hits,
                                       const clarity_watch* watch) {
    return run_call([&] {
        Watched progress = watched(watch);
        not_null(tracer, "tracer").closest(copy_of(rays, "clarity_rays"), copy_of(hits, "clarity_hits"), progress);
    });
}

CLARITY_EXPORT int32_t clarity_pack(clarity_tracer* tracer, const clarity_rays* rays, const clarity_watch* watch,
                                    clarity_packed** packed) {
    return run_call([&] {
        clarity_packed*& result = not_null(packed, "packed");
        Watched progress = watched(watch);
        result = not_null(tracer, "tracer").pack(copy_of(rays, "clarity_rays"), progress).release();
    });
}

CLARITY_EXPORT void clarity_packed_free(clarity_packed* packed) {
    run_free([&] { delete packed; });
}

CLARITY_EXPORT int32_t clarity_kept_new(const clarity_tracer* tracer, int32_t brief, clarity_kept** kept) {
    return run_call([&] { not_null(kept, "kept") = not_null(tracer, "tracer").new_kept(brief != 0).release(); });
}

CLARITY_EXPORT int32_t clarity_keep(clarity_tracer* tracer, const clarity_rays* rays, clarity_kept* kept,
                                    const clarity_watch* watch) {
    return run_call([&] {
        Watched progress = watched(watch);
        not_null(tracer, "tracer").keep(copy_of(rays, "clarity_rays"), not_null(kept, "kept"), progress);
    });
}

CLARITY_EXPORT int32_t clarity_kept_array(clarity_kept* kept, int32_t which, void** array) {
    return run_call([&] {
        void*& result = not_null(array, "array");
        if (which < CLARITY_HIT_T || which > CLARITY_HIT_INSTANCE)
            throw Error(Exit::usage, "hits have no array " + std::to_string(which) + ": CLARITY_HIT_T to CLARITY_HIT_INSTANCE");
        result = not_null(kept, "kept").array(static_cast<AnswerArray>(which));
    });
}

CLARITY_EXPORT void clarity_kept_free(clarity_kept* kept) {
    run_free([&] { delete kept; });
}

CLARITY_EXPORT int32_t clarity_any(clarity_tracer* tracer, const clarity_rays* rays, uint8_t* occluded,
                                   const clarity_watch* watch) {
    return run_call([&] {
        Watched progress = watched(watch);
        not_null(tracer, "tracer").any(copy_of(rays, "clarity_rays"), occluded, progress);
    });
}

CLARITY_EXPORT int32_t clarity_count(clarity_tracer* tracer, const clarity_rays* rays, int64_t* counts,
                                     const clarity_watch* watch) {
    return run_call([&] {
        Watched progress = watched(watch);
        not_null(tracer, "tracer").count(copy_of(rays, "clarity_rays"), counts, progress);
    });
}

CLARITY_EXPORT int32_t clarity_all(clarity_tracer* tracer, const clarity_rays* rays, clarity_all_hits* hits,
                                   const clarity_watch* watch) {
    return run_call([&] {
        Watched progress = watched(watch);
        copy_of(hits, "clarity_all_hits");  // checks it
        give_hits(not_null(tracer, "tracer").all(copy_of(rays, "clarity_rays"), progress), *hits);
    });
}

CLARITY_EXPORT void clarity_all_hits_free(clarity_all_hits* hits) {
    if (hits) run_free([&] { take_back_hits(*hits); });
}

CLARITY_EXPORT int32_t clarity_move(clarity_tracer* tracer, const clarity_places* places, const clarity_watch* watch) {
    return run_call([&] {
        Watched progress = watched(watch);
        not_null(tracer, "tracer").move(copy_of(places, "clarity_places"), progress);
    });
}

CLARITY_EXPORT int32_t clarity_rows(const char* const* words, void (*row)(void*, const char*), void* user,
                                    const clarity_watch* watch) {
    return run_call([&] {
        std::vector<std::string> texts;
        for (const char* const* word = &not_null(words, "words"); *word; ++word) texts.emplace_back(*word);
        Watched progress = watched(watch);
        give_rows(
            std::move(texts),
            [&](const std::string& json) {
                const InCallersFunction calling;
                if (row) row(user, json.c_str());
            },
            progress);
    });
}

CLARITY_EXPORT int32_t clarity_render(clarity_tracer* tracer, clarity_picture* picture, const clarity_watch* watch) {
    return run_call([&] {
        Watched progress = watched(watch);
        const clarity_picture asked = copy_of(picture, "clarity_picture");  // checks it, before *picture
        not_null(tracer, "tracer").render(asked, *picture, progress);
    });
}
