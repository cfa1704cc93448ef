// device_refit_test.cpp -- refits on the device of layouts that the host builds: the bytes of the host's refits.
#include <gtest/gtest.h>

#include <cstring>

#include "moving/on_device/device_mover.hpp"
#include "moving/on_host/host_mover.hpp"
#include "moving_scenes.hpp"
#include "plugin/capabilities.hpp"
#include "stand/multi_preparer.hpp"

namespace clarity::test {
namespace {

struct Case {
    const char* accel;
    BuildForm form;
};

// rings(), whose ring and ball have trees of their own.
ScenePtr scene_of_trees() {
    static const ScenePtr scene = [] {
        Scene s = *rings();
        s.instances[0].apart = s.instances[1].apart = true;
        return std::make_shared<const Scene>(std::move(s));
    }();
    return scene;
}

class DeviceRefit : public ::testing::TestWithParam<Case> {
 protected:
    // The first word in which a slot on the device differs from the host's; empty: none. Zeros of either sign are the same in
    // a node of floats.
    static std::string difference(Device& device, const cl::Buffer& buffer, const AccelData::Slot& expected, bool floats) {
        std::vector<uint32_t> words(expected.memory.bytes() / 4);
        device.queue().enqueueReadBuffer(buffer, CL_TRUE, 0, 4 * words.size(), words.data());
        const auto* const wanted = static_cast<const uint32_t*>(expected.memory.data());
        for (size_t i = 0; i < words.size(); ++i)
            if (words[i] != wanted[i] && !(floats && (words[i] | wanted[i]) == 0x80000000u))
                return "word " + std::to_string(i) + " is " + std::to_string(words[i]) + " instead of " +
                       std::to_string(wanted[i]);
        return {};
    }
};

TEST_P(DeviceRefit, GivesTheBytesOfTheHost) {
    Progress progress;
    const auto device = Workbench::get().shared_device();
    const rt_plugin* const plugin = Workbench::get().plugins().accel(GetParam().accel);
    ASSERT_TRUE(plugin && device_build_of(*plugin).refit);
    const auto built = build(scene_of_trees(), *plugin);
    Settings settings;
    settings.lanes = 1;
    const auto prepared = prepare_queries(*device, scene_of_trees(), built, settings, progress);
    DeviceMover motion(device, scene_of_trees(), built, prepared->on_device, nullptr, GetParam().form);
    ASSERT_EQ(motion.cannot(), "");
    HostMover host(scene_of_trees(), built);
    for (const float phase : {0.0f, 1.0f, 2.0f, 5.0f, 0.0f}) {
        SCOPED_TRACE(phase);
        Pose pose = phase > 0 ? waved(*scene_of_trees(), phase) : pose_at_rest(*scene_of_trees());
        if (phase == 5)  // the ring lies in a plane
            for (size_t v = 0; v < pose.meshes[0].positions.size(); v += 3) pose.meshes[0].positions[v + 1] = 0.25f;
        if (phase == 2)  // the ball is a point
            for (float& x : pose.meshes[1].positions) x = 0.1f;
        const MovedOnDevice moved = motion.move(pose);
        ASSERT_TRUE(moved.on_device) << moved.why;
        const MovedStructure expected = host.move(pose, progress);
        ASSERT_TRUE(expected.accel);
        EXPECT_EQ(difference(*device, moved.on_device->moving().slots[0], expected.accel->slots[0],
                             GetParam().accel != std::string("cwbvh")),
                  "");
    }
}

INSTANTIATE_TEST_SUITE_P(, DeviceRefit,
                         ::testing::Values(Case{"bvh8", BuildForm::groups}, Case{"bvh8", BuildForm::serial},
                                           Case{"cwbvh", BuildForm::groups}, Case{"cwbvh", BuildForm::serial}),
                         [](const auto& info) {
                             return std::string(info.param.accel) +
                                    (info.param.form == BuildForm::groups ? "_groups" : "_serial");
                         });

}  // namespace
}  // namespace clarity::test
