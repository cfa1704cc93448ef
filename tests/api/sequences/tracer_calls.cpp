// tracer_calls.cpp -- calls that make, ask, move and free tracers.
#include <cmath>

#include "arguments.hpp"
#include "call_lists.hpp"

namespace sequences {
namespace {

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
    else
        watch.ended(step, code);
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
    if (wrong)
        step.ended(code, CLARITY_USAGE, words);
    else
        watch.ended(step, code);
}

}  // namespace

// A new tracer is rare: PoCL takes as long to load its programs as for a thousand calls.
const std::vector<Call> kTracerCalls = {
    {"clarity_tracer_new", 0.05, tracer_new},
    {"clarity_tracer_info", 2, tracer_info},
    {"clarity_tracer_free", 0.02, tracer_free},
    {"clarity_move", 1.5, tracer_move},
};

}  // namespace sequences
