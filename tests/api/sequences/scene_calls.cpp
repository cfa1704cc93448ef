// scene_calls.cpp -- calls that make, ask and free scenes.
#include <unistd.h>

#include <cmath>
#include <limits>

#include "arguments.hpp"
#include "call_lists.hpp"

namespace sequences {

World Scene::world(const Pose& pose) const {
    World world;
    world.size = size;
    world.numbers_known = of_arrays;
    const auto placed = [](const Transform& m, const Point& p) {
        Point to;
        for (size_t k = 0; k < 3; ++k) to[k] = m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3];
        return to;
    };
    for (const Transform& transform : pose.transforms)
        for (size_t i = 0; i + 2 < triangles.size(); i += 3) {
            Triangle triangle{{}, world.prim_count++};
            for (size_t k = 0; k < 3; ++k) triangle.corners[k] = placed(transform, pose.positions[triangles[i + k]]);
            world.triangles.push_back(triangle);
        }
    world.spheres = spheres;
    world.prim_count += static_cast<int32_t>(spheres.size());
    world.instance_count = static_cast<int32_t>(pose.transforms.size());
    return world;
}

namespace {

constexpr Transform kNoTransform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

// Small triangles in a cube; some have no area, some are there twice.
void draw_mesh(Draw& draw, Scene& scene) {
    const size_t count = draw.chance(0.05) ? 1 : 1 + draw.below(24);
    scene.size = draw.one_of({1.0, 1.0, 1.0, 100.0, 0.01});
    for (size_t i = 0; i < count; ++i) {
        const auto first = static_cast<uint32_t>(scene.at_rest.positions.size());
        if (i > 0 && draw.chance(0.05)) {
            for (int k = 0; k < 3; ++k) scene.triangles.push_back(scene.triangles[scene.triangles.size() - 3]);
            continue;
        }
        Point middle;
        for (double& x : middle) x = draw.real();
        const bool flat = draw.chance(0.03);
        for (int k = 0; k < 3; ++k) {
            Point corner = middle;
            for (double& x : corner) x = scene.far + scene.size * (x + (flat && k == 2 ? 0 : draw.real(-0.3, 0.3)));
            scene.at_rest.positions.push_back(corner);
            scene.triangles.push_back(first + static_cast<uint32_t>(flat && k == 2 ? 0 : k));
        }
    }
    scene.at_rest.transforms = {kNoTransform};
}

void scene_from_mesh(Step& step) {
    Draw& draw = step.draw;
    const auto scene = std::make_shared<Scene>();
    const bool is_double = draw.chance(0.4);
    if (is_double && draw.chance(0.3)) scene->far = draw.one_of({1e6, -3e7});
    draw_mesh(draw, *scene);
    Bytes positions = positions_as(is_double, scene->at_rest.positions);
    Bytes triangles(scene->triangles.size() * sizeof(uint32_t));
    std::memcpy(triangles.as<char>(), scene->triangles.data(), triangles.size());
    clarity_mesh mesh{};
    mesh.type = is_double ? CLARITY_FLOAT64 : CLARITY_FLOAT32;
    mesh.vertex_count = scene->at_rest.positions.size();
    mesh.triangle_count = scene->triangles.size() / 3;
    mesh.positions = positions.as<void>();
    mesh.triangles = triangles.as<uint32_t>();
    Struct<clarity_mesh> given(draw, mesh);
    const bool wrong = draw.chance(0.2);
    const Watch watch(draw, !wrong);
    const clarity_mesh* argument = given.get();
    clarity_scene** result = &scene->handle;
    const char* words = "";
    const auto last = draw.below(mesh.vertex_count * 3);
    bool huge = false;  // of scenes, numbers beyond 1e15 may be refused or not
    if (wrong) switch (draw.below(9)) {
            case 0:
                argument = nullptr, words = "clarity_mesh is null";
                break;
            case 1:
                result = nullptr, words = "`scene` is null";
                break;
            case 2:
                given.spoil(draw.one_of({0u, 8u, 20u})), words = "clarity_mesh::struct_bytes";
                break;
            case 3:
                given.get()->type = draw.one_of({-1, 2, 7, 1 << 30}), words = "unknown type";
                break;
            case 4:
                triangles.as<uint32_t>()[draw.below(scene->triangles.size())] =
                    draw.one_of({static_cast<uint32_t>(mesh.vertex_count), 0x7fffffffu, 0xffffffffu});
                words = "vertex";
                break;
            case 5:
                given.get()->positions = nullptr, words = "null pointer";
                break;
            case 6:
                given.get()->triangles = nullptr, words = "null pointer";
                break;
            case 7:
                (draw.chance(0.5) ? given.get()->triangle_count : given.get()->vertex_count) =
                    draw.one_of<uint64_t>({UINT64_MAX, UINT64_MAX / 3, uint64_t{1} << 31, uint64_t{1} << 62});
                words = "2^31";
                break;
            default: {
                const double odd = draw.one_of({std::nan(""), double(INFINITY), -1e30, 2e15});
                huge = std::isfinite(odd);
                if (is_double)
                    positions.as<double>()[last] = odd;
                else
                    positions.as<float>()[last] = float(odd);
                words = "mesh of arrays";
            }
        }
    ++calls_made;
    const int32_t code = clarity_scene_from_mesh(argument, watch.get(), result);
    if (wrong)
        step.ended(code, CLARITY_USAGE, words, huge);
    else
        watch.ended(step, code);
    step.must((code == CLARITY_OK) == (scene->handle != nullptr), "a scene without CLARITY_OK, or the reverse");
    if (code != CLARITY_OK || wrong) return;
    if (!is_double) scene->lent_positions = std::move(positions);  // else they were copied, and go now
    scene->lent_triangles = std::move(triangles);
    step.state.scenes.put(draw, scene);
}

void scene_load(Step& step) {
    Draw& draw = step.draw;
    const bool wrong = draw.chance(0.5);
    const auto scene = std::make_shared<Scene>();
    const std::string missing = step.common.folder + "/missing.obj";
    const char* const files[] = {wrong ? missing.c_str() : step.common.scene_file.c_str(), nullptr};
    const Watch watch(draw, !wrong);
    int32_t expected = CLARITY_OK;
    const char* words = "";
    ++calls_made;
    int32_t code;
    switch (wrong ? draw.below(4) : 9) {
        case 0:
            code = clarity_scene_load(nullptr, 1, watch.get(), &scene->handle), words = "`files` is null";
            break;
        case 1:
            code = clarity_scene_load(files, 1, watch.get(), nullptr), words = "`scene` is null";
            break;
        case 2:
            code = clarity_scene_load(files, 2, watch.get(), &scene->handle), words = "`files[i]` is null";
            break;
        case 3:
            code = clarity_scene_load(files, 1, watch.get(), &scene->handle);
            expected = CLARITY_IMPORT_FAILED, words = "missing.obj";
            break;
        default:
            code = clarity_scene_load(files, 1, watch.get(), &scene->handle);
    }
    if (wrong)
        step.ended(code, expected ? expected : int32_t{CLARITY_USAGE}, words);
    else
        watch.ended(step, code);
    if (code != CLARITY_OK) return;
    scene->of_arrays = false;
    scene->triangles = step.common.file_triangles;
    scene->at_rest.positions = step.common.file_positions;
    scene->at_rest.transforms = {kNoTransform, kNoTransform};
    scene->at_rest.transforms[0][3] = 0.25;
    scene->at_rest.transforms[1][7] = 1.5;
    scene->spheres = {{{0.5, 0.5, 2}, 0.75, -1}};
    step.state.scenes.put(draw, scene);
}

void scene_ask(Step& step) {
    const std::shared_ptr<Scene> scene = step.state.scenes.any(step.draw);
    const char* json = nullptr;
    double lo[3] = {7, 7, 7}, hi[3] = {7, 7, 7};
    ++calls_made;
    if (step.draw.chance(0.5)) {
        const bool wrong = step.draw.chance(0.2);
        const int32_t code = clarity_scene_info(scene ? scene->handle : nullptr, wrong ? nullptr : &json);
        if (wrong || !scene) return step.ended(code, CLARITY_USAGE, "is null");
        step.ended(code);
        return step.must(std::strstr(json, "\"triangles\"") != nullptr, "the scene's info has no triangles");
    }
    const int wrong = step.draw.chance(0.2) ? 1 + int(step.draw.below(2)) : 0;
    const int32_t code =
        clarity_scene_bounds(scene ? scene->handle : nullptr, wrong == 1 ? nullptr : lo, wrong == 2 ? nullptr : hi);
    if (wrong || !scene) {
        step.must(lo[0] == 7 && hi[2] == 7, "a failed call has written bounds");
        return step.ended(code, CLARITY_USAGE, "is null");
    }
    step.ended(code);
    for (const Triangle& triangle : scene->world(scene->at_rest).triangles)
        for (const Point& corner : triangle.corners)
            for (size_t k = 0; k < 3; ++k) {
                const double slack = 1e-5 * scene->size;
                step.must(corner[k] >= lo[k] - slack && corner[k] <= hi[k] + slack,
                          "a corner is outside of the scene's bounds");
            }
}

void scene_free(Step& step) {
    step.state.scenes.put(step.draw, nullptr);  // also while a tracer of it lives
}

}  // namespace

const std::vector<Call> kSceneCalls = {
    {"clarity_scene_from_mesh", 1.5, scene_from_mesh},
    {"clarity_scene_load", 0.01, scene_load},
    {"clarity_scene_info", 3, scene_ask},
    {"clarity_scene_free", 1, scene_free},
};

}  // namespace sequences
