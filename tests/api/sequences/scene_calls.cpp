// scene_calls.cpp -- calls that make, ask, move and free scenes and tracers.
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

// Positions as numbers of a type, and what the library makes of them.
Bytes positions_as(bool is_double, std::vector<Point>& positions) {
    Bytes bytes(positions.size() * 3 * (is_double ? 8 : 4));
    for (size_t i = 0; i < positions.size(); ++i)
        for (size_t k = 0; k < 3; ++k) {
            if (is_double)
                bytes.as<double>()[3 * i + k] = positions[i][k];
            else
                positions[i][k] = bytes.as<float>()[3 * i + k] = float(positions[i][k]);
        }
    return bytes;
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
    if (wrong || watch.kind == Watch::Kind::wrong)
        step.ended(code, CLARITY_USAGE, wrong ? words : "clarity_watch::struct_bytes", huge);
    else if (watch.kind == Watch::Kind::cancelled || watch.kind == Watch::Kind::cancels_soon)
        step.ended(code, CLARITY_CANCELLED, "", watch.kind == Watch::Kind::cancels_soon);
    else
        step.ended(code);
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
    else if (watch.kind == Watch::Kind::wrong)
        step.ended(code, CLARITY_USAGE, "clarity_watch::struct_bytes");
    else if (watch.kind == Watch::Kind::cancelled || watch.kind == Watch::Kind::cancels_soon)
        step.ended(code, CLARITY_CANCELLED, "", watch.kind == Watch::Kind::cancels_soon);
    else
        step.ended(code);
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

void tracer_new(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Scene> scene = step.state.scenes.any(draw);
    const auto tracer = std::make_shared<Tracer>();
    tracer->accel = step.common.accels[draw.below(step.common.accels.size())];
    std::string device, accel = tracer->accel;
    std::vector<std::string> texts;
    if (draw.chance(0.4)) texts.push_back(draw.one_of({"poses=refit", "poses=build", "poses=auto"}));
    const bool wrong = draw.chance(0.2), null_scene = !scene;
    const Watch watch(draw, !wrong && !null_scene);
    Struct<clarity_options> options(draw, clarity_options{});
    clarity_tracer** result = &tracer->handle;
    int32_t expected = CLARITY_USAGE;
    const char* words = "";
    if (wrong) switch (draw.below(7)) {
            case 0:
                accel = draw.one_of({"no_such_tree", ",", "bvh2,max_leaf=-3", "bvh2,max_leaf", "bvh2,,=", "\xff\xfe"});
                break;
            case 1:
                accel = std::string(100000, 'x');
                break;
            case 2:
                texts.emplace_back(draw.one_of({"no_such_setting=1", "word", "=", "", "spp=many", "size=1"}));
                break;
            case 3:
                texts.emplace_back("light.0=off"), words = "clarity_render";
                break;
            case 4:
                device = "no such device", expected = CLARITY_NO_DEVICE, words = "no such device";
                break;
            case 5:
                options.spoil(draw.one_of({0u, 4u, 16u})), words = "clarity_options::struct_bytes";
                break;
            default:
                result = nullptr, words = "`tracer` is null";
        }
    // Texts and their list go when the call has ended.
    std::vector<const char*> settings;
    for (const std::string& text : texts) settings.push_back(text.c_str());
    settings.push_back(nullptr);
    options.get()->device = device.empty() && draw.chance(0.5) ? nullptr : device.c_str();
    options.get()->accel = accel.c_str();
    options.get()->settings = texts.empty() && draw.chance(0.5) ? nullptr : settings.data();
    const Scene* const of = scene.get();
    ++calls_made;
    const int32_t code = clarity_tracer_new(of ? of->handle : nullptr, options.get(), watch.get(), result);
    if (wrong || null_scene)
        step.ended(code, null_scene && code == CLARITY_USAGE ? int32_t{CLARITY_USAGE} : expected, null_scene ? "" : words);
    else if (watch.kind == Watch::Kind::wrong)
        step.ended(code, CLARITY_USAGE, "clarity_watch::struct_bytes");
    else if (watch.kind == Watch::Kind::cancelled || watch.kind == Watch::Kind::cancels_soon)
        step.ended(code, CLARITY_CANCELLED, "", watch.kind == Watch::Kind::cancels_soon);
    else
        step.ended(code);
    step.must((code == CLARITY_OK) == (tracer->handle != nullptr), "a tracer without CLARITY_OK, or the reverse");
    if (code != CLARITY_OK) return;
    tracer->scene = scene;
    tracer->pose = scene->at_rest;
    tracer->worlds.push_back(std::make_shared<const World>(scene->world(tracer->pose)));
    step.state.tracers.put(draw, tracer);
}

void tracer_info(Step& step) {
    const std::shared_ptr<Tracer> tracer = step.state.tracers.any(step.draw);
    const char* json = nullptr;
    const bool wrong = step.draw.chance(0.1);
    ++calls_made;
    const int32_t code = clarity_tracer_info(tracer ? tracer->handle : nullptr, wrong ? nullptr : &json);
    if (wrong || !tracer) return step.ended(code, CLARITY_USAGE, "is null");
    step.ended(code);
    step.must(std::strstr(json, "\"accel\"") != nullptr, "the tracer's info has no structure");
}

void tracer_free(Step& step) {
    step.state.tracers.put(step.draw, nullptr);
}

Transform drawn_transform(Draw& draw) {
    Transform m;
    const double turn = draw.real(0, 6.3), scale = draw.real(0.6, 1.5), c = scale * std::cos(turn), s = scale * std::sin(turn);
    m = {c,
         -s,
         0,
         draw.real(-0.5, 0.5),
         s,
         c,
         0,
         draw.real(-0.5, 0.5),
         0,
         0,
         draw.chance(0.2) ? -scale : scale,
         draw.real(-0.5, 0.5)};
    return m;
}

void tracer_move(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Tracer> tracer = step.state.tracers.any(draw);
    clarity_places places{};
    if (!tracer) {
        ++calls_made;
        return step.ended(clarity_move(nullptr, Struct<clarity_places>(draw, places).get(), nullptr), CLARITY_USAGE,
                          "`tracer` is null");
    }
    // One thread moves a tracer, and others trace it, or move it wrongly.
    const std::unique_lock<std::mutex> moving(tracer->moving, std::try_to_lock);
    const Scene& scene = *tracer->scene;
    const bool is_double = scene.far != 0 || draw.chance(0.3), wrong = !moving || draw.chance(0.2);
    Pose to = tracer->pose;
    const bool of_vertices = scene.of_arrays && draw.chance(0.6);
    const bool of_instances = scene.far == 0 && (!of_vertices || draw.chance(0.3));
    Bytes positions, transforms;
    places.type = is_double ? CLARITY_FLOAT64 : CLARITY_FLOAT32;
    if (of_vertices) {
        for (Point& point : to.positions)
            for (double& x : point) x += scene.size * draw.real(-0.1, 0.1);
        if (draw.chance(0.3)) to.positions = scene.at_rest.positions;
        positions = positions_as(is_double, to.positions);
        places.positions = positions.as<void>();
        places.vertex_count = to.positions.size();
    }
    if (of_instances) {
        transforms = Bytes(to.transforms.size() * 12 * (is_double ? 8 : 4));
        for (size_t i = 0; i < to.transforms.size(); ++i) {
            to.transforms[i] = drawn_transform(draw);
            for (size_t k = 0; k < 3; ++k) to.transforms[i][4 * k + 3] *= scene.size;
            for (size_t k = 0; k < 12; ++k) {
                if (is_double)
                    transforms.as<double>()[12 * i + k] = to.transforms[i][k];
                else
                    to.transforms[i][k] = transforms.as<float>()[12 * i + k] = float(to.transforms[i][k]);
            }
        }
        places.transforms = transforms.as<void>();
        places.instance_count = to.transforms.size();
    }
    Struct<clarity_places> given(draw, places);
    const clarity_places* argument = given.get();
    const char* words = "";
    const Watch watch(draw, !wrong);
    const double odd = draw.one_of({std::nan(""), double(INFINITY), 1e30});
    if (wrong) switch (draw.below(moving ? 7 : 4)) {
            case 0:
                argument = nullptr, words = "clarity_places is null";
                break;
            case 1:
                given.spoil(draw.one_of({0u, 12u})), words = "clarity_places::struct_bytes";
                break;
            case 2:
                given.get()->type = draw.one_of({-1, 2, 99}), words = "unknown type";
                break;
            case 3:
                (of_vertices ? given.get()->vertex_count : given.get()->instance_count) =
                    draw.one_of<uint64_t>({0, 1u << 20, UINT64_MAX});
                words = of_vertices || of_instances ? "nothing was moved" : "";
                if (!of_vertices && !of_instances) argument = nullptr;
                break;
            case 4:
                if (of_vertices)
                    is_double ? void(positions.as<double>()[0] = odd) : void(positions.as<float>()[0] = float(odd));
                else if (of_instances)
                    is_double ? void(transforms.as<double>()[5] = odd) : void(transforms.as<float>()[5] = float(odd));
                else
                    argument = nullptr;
                break;
            case 5:
                if (of_instances)
                    for (int k = 0; k < 12; ++k)
                        is_double ? void(transforms.as<double>()[k] = 0) : void(transforms.as<float>()[k] = 0);
                else
                    argument = nullptr;
                break;
            default:
                // Vertices of a file's scene; instances of a scene that lies far away.
                if (!scene.of_arrays) {
                    positions = Bytes(scene.at_rest.positions.size() * 24);
                    given.get()->positions = positions.as<void>(), given.get()->vertex_count = scene.at_rest.positions.size();
                    words = "move the instances";
                } else if (scene.far != 0) {
                    transforms = Bytes(96);
                    given.get()->transforms = transforms.as<void>(), given.get()->instance_count = 1;
                    words = "stay where they are";
                } else {
                    argument = nullptr;
                }
        }
    if (!wrong) {
        const auto world = std::make_shared<const World>(scene.world(to));
        const std::lock_guard<std::mutex> lock(tracer->lock);
        tracer->worlds.push_back(world);
        ++tracer->begun;
    }
    ++calls_made;
    const int32_t code = clarity_move(tracer->handle, argument, watch.get());
    if (!wrong) {
        const std::lock_guard<std::mutex> lock(tracer->lock);
        if (code == CLARITY_OK) {
            tracer->pose = to;
        } else {
            tracer->worlds.back() = tracer->worlds[tracer->ended - 1];
        }
        tracer->ended = tracer->begun;
    }
    if (wrong || watch.kind == Watch::Kind::wrong)
        step.ended(code, CLARITY_USAGE, wrong ? words : "clarity_watch::struct_bytes");
    else if (watch.kind == Watch::Kind::cancelled || watch.kind == Watch::Kind::cancels_soon)
        step.ended(code, CLARITY_CANCELLED, "", watch.kind == Watch::Kind::cancels_soon);
    else
        step.ended(code);
}

}  // namespace

const std::vector<Call> kSceneCalls = {
    {"clarity_scene_from_mesh", 1.5, scene_from_mesh},
    {"clarity_scene_load", 0.01, scene_load},
    {"clarity_scene_info", 3, scene_ask},
    {"clarity_scene_free", 1, scene_free},
    {"clarity_tracer_new", 0.3, tracer_new},
    {"clarity_tracer_info", 2, tracer_info},
    {"clarity_tracer_free", 0.15, tracer_free},
    {"clarity_move", 1.5, tracer_move},
};

}  // namespace sequences
