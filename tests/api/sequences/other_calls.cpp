// other_calls.cpp -- pictures, rows, the log, texts of errors, and nothing at all.
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>

#include "arguments.hpp"
#include "call_lists.hpp"

namespace sequences {
namespace {

void render(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Tracer> tracer = step.state.tracers.any(draw);
    const bool wrong = draw.chance(0.3);
    const size_t width = 1 + draw.below(9), height = 1 + draw.below(9);
    // Each structure has a program of its own for pictures, which takes seconds to compile: one of them has to do.
    const bool traces = tracer && tracer->accel == step.common.accels[0] && tracer->scene->of_arrays && draw.chance(0.2);
    const std::string size = "size=" + std::to_string(width) + "x" + std::to_string(height);
    const char* settings[] = {size.c_str(), draw.one_of({"aov=t", "spp=1", "spp=3"}), nullptr, nullptr};
    const size_t channels = settings[1][0] == 'a' ? 1 : 3, floats = width * height * channels;
    Bytes pixels(floats * sizeof(float));
    clarity_picture picture{};
    picture.settings = settings;
    picture.room = floats + draw.below(3) * 1000;
    if (traces || wrong) picture.pixels = pixels.as<float>();
    Struct<clarity_picture> given(draw, picture);
    clarity_picture* argument = given.get();
    const Watch watch(draw, !wrong && tracer);
    const char* words = "";
    if (wrong) switch (draw.below(6)) {
            case 0:
                argument = nullptr, words = "clarity_picture is null";
                break;
            case 1:
                given.spoil(draw.one_of({0u, 16u})), words = "clarity_picture::struct_bytes";
                break;
            case 2:
                given.get()->room = draw.below(floats), words = "is room for";
                break;
            case 3:
                given.get()->camera = draw.one_of({"no such camera", "1,2", "nan,0,0,0,0,0,0"});
                break;
            case 4:
                settings[1] = draw.one_of({"hide=0", "size=0x0", "size=-1x4", "aov=nothing", "spp=", "tracer=nobody"});
                break;
            default:
                given.get()->light = draw.one_of({"moon", "1,2", "="});
        }
    ++calls_made;
    const int32_t code = clarity_render(tracer ? tracer->handle : nullptr, argument, watch.get());
    if (wrong || !tracer)
        step.ended(code, CLARITY_USAGE, tracer ? words : "");
    else
        watch.ended(step, code, !traces);
    if (code != CLARITY_OK) {
        step.must(pixels.is_untouched(), "a failed call has written pixels");
        return step.must(given.get()->width == 0 && given.get()->channels == 0, "a failed call has written a size");
    }
    const clarity_picture& got = *given.get();
    step.must(got.width == width && got.height == height && got.channels == channels, "the picture has another size");
    if (traces)
        for (size_t i = 0; i < floats; ++i) step.must(!(pixels.as<float>()[i] < 0), "a pixel is negative");
}

void rows(Step& step) {
    const char* words[] = {step.draw.one_of({"info", "", "render", "check me"}), nullptr};
    ++calls_made;
    if (step.draw.chance(0.5))
        return step.ended(clarity_rows(nullptr, nullptr, nullptr, nullptr), CLARITY_USAGE, "`words` is null");
    step.ended(clarity_rows(words + step.draw.below(2), nullptr, nullptr, nullptr), CLARITY_USAGE, "clarity bench");
}

void set_program(Step& step) {
    const std::string program = step.draw.one_of({"/no/such/program", "/", "/bin/sh"});
    ++calls_made;
    if (step.draw.chance(0.3)) return step.ended(clarity_set_program(nullptr), CLARITY_USAGE, "`path` is null");
    step.ended(clarity_set_program(program.c_str()), CLARITY_USAGE, program == "/bin/sh" ? "in use already" : program.c_str());
}

std::atomic<uint64_t> log_lines{0};

void set_log(Step& step) {
    const auto listener = [](void* user, int32_t level, const char* text) {
        if (user != &log_lines || level < CLARITY_LOG_DEBUG || level > CLARITY_LOG_ERROR || !text[0]) std::abort();
        ++log_lines;
    };
    ++calls_made;
    if (step.draw.chance(0.3)) return step.ended(clarity_set_log(nullptr, nullptr));
    step.ended(clarity_set_log(listener, &log_lines));
}

// A failed call, what is told of it, and a call that works, after which nothing is told.
void error_texts(Step& step) {
    calls_made += 7;
    step.ended(clarity_scene_info(nullptr, nullptr), CLARITY_USAGE, "is null");
    const std::string text = clarity_error_text();
    step.must(text == clarity_error_text() && !clarity_error_details()[0], "the text of an error has changed");
    step.must(clarity_version()[0] && std::strlen(clarity_header_digest()) == 64, "no version");
    clarity_scene_free(nullptr);
    step.must(text == clarity_error_text(), "a free has changed the text of an error");
}

void free_nothing(Step&) {
    calls_made += 5;
    clarity_scene_free(nullptr);
    clarity_tracer_free(nullptr);
    clarity_packed_free(nullptr);
    clarity_kept_free(nullptr);
    clarity_all_hits_free(nullptr);
}

// A child that was forked gets an error from each call. Not with AddressSanitizer, whose locks other threads may hold.
void forked(Step& step) {
#ifndef __SANITIZE_ADDRESS__
    if (step.state.threads > 1) return;
    const std::shared_ptr<Scene> scene = step.state.scenes.any(step.draw);
    const pid_t child = fork();
    if (child == 0) {
        alarm(20);
        const char* json = nullptr;
        const bool refused =
            clarity_scene_info(scene ? scene->handle : nullptr, &json) == CLARITY_FORKED && clarity_error_text()[0];
        clarity_scene_free(scene ? scene->handle : nullptr);
        _exit(refused ? 0 : 1);
    }
    int status = -1;
    step.must(child > 0 && waitpid(child, &status, 0) == child && status == 0, "a forked child was not refused");
#else
    (void)step;
#endif
}

}  // namespace

const std::vector<Call> kOtherCalls = {
    {"clarity_render", 1.5, render},
    {"clarity_rows", 0.5, rows},
    {"clarity_set_program", 0.5, set_program},
    {"clarity_set_log", 0.5, set_log},
    {"clarity_error_text", 1, error_texts},
    {"clarity_*_free(NULL)", 1, free_nothing},
    {"fork", 0.002, forked},
};

}  // namespace sequences
