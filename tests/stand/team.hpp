// team.hpp -- one CPU as a whole and in parts, to compare their pictures.
#pragma once
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "stand/multi_frame_renderer.hpp"
#include "support/scenes.hpp"
#include "view/view.hpp"

namespace clarity::test {

// A choice of devices, with a preparer and a renderer for them.
struct Team {
    explicit Team(const std::string& choice)
        : devices(open_devices(choose_devices(choice))), preparer(Workbench::get().plugins(), devices), frames(devices) {}
    Devices devices;
    MultiPreparer preparer;
    MultiFrameRenderer frames;
    Progress progress;

    FrameStats trace(const ScenePtr& scene, const Settings& settings, const View& view, unsigned sample = 0,
                     unsigned samples = 1) {
        return frames.trace(preparer.prepare(scene, with_optics(settings, *scene, view), progress), settings, view, sample,
                            true, progress, samples);
    }
};

inline Team& whole_cpu() {
    static Team* const team = new Team("cpu");  // never destroyed: an OpenCL driver may be gone before static objects are
    return *team;
}

// Why this machine cannot split its CPU; empty if it can.
inline std::string why_no_parts() {
    try {
        choose_devices("cpu/2");
        return {};
    } catch (const Error& e) {
        return std::string("NOT TESTED: ") + e.what();
    }
}

inline size_t differing(const FloatPixels& a, const FloatPixels& b) {
    size_t differ = a.size() == b.size() ? 0 : ~size_t(0) / 2;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) differ += std::memcmp(&a[i], &b[i], sizeof a[i]) != 0;
    return differ;
}

}  // namespace clarity::test
