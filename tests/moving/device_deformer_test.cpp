// device_deformer_test.cpp -- vertices that a device makes, against those that the host makes.
#include "moving/on_device/device_deformer.hpp"

#include <gtest/gtest.h>

#include <random>

#include "moving/on_device/device_mover.hpp"
#include "moving/on_host/host_mover.hpp"
#include "moving_scenes.hpp"
#include "scene/motion/deform.hpp"
#include "stand/multi_preparer.hpp"
#include "support/scenes.hpp"

namespace clarity::test {
namespace {

std::mt19937 randomness(11);
double any(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(randomness);
}
bool happens(double share) {
    return any(0, 1) < share;
}

// Meshes with each kind of deformation, and one with all of them. Each is a ring with normals, of which some are missing.
enum { kStill, kFrames, kMorphs, kLinear, kDual, kBlended, kAll, kMeshes };
constexpr rt_u32 kBones = 5;

void add_frames(Motion& m, const Mesh& mesh, rt_u32 number) {
    m.frames.push_back({number, 0, m.frame_times.size(), 3, m.frame_positions.size()});
    for (int f = 0; f < 3; ++f) {
        m.frame_times.push_back(f);
        for (rt_u32 i = 0; i < 3 * mesh.vertex_count; ++i) m.frame_positions.push_back(float(any(-1, 1)));
    }
}
// Two morphs, the second of which has a target in between. Each target moves a third of the vertices; one has no normals.
void add_morphs(Motion& m, const Mesh& mesh, rt_u32 number) {
    for (const rt_u32 targets : {1, 2}) {
        m.morphs.push_back({"", number, rt_u32(m.morph_targets.size()), targets, 0});
        for (rt_u32 t = 0; t < targets; ++t) {
            MorphTarget target{t + 1 < targets ? 0.5 : 1.0, m.morph_vertices.size(), 0, m.morph_normals.size(), targets > 1};
            for (rt_u32 v = 0; v < mesh.vertex_count; ++v) {
                if (!happens(1 / 3.0)) continue;
                m.morph_vertices.push_back(v);
                ++target.count;
                for (int k = 0; k < 3; ++k) m.morph_positions.push_back(float(any(-0.3, 0.3)));
                for (int k = 0; target.has_normals && k < 3; ++k) m.morph_normals.push_back(float(any(-0.5, 0.5)));
            }
            m.morph_targets.push_back(target);
        }
    }
}
// Every tenth vertex has no weights.
void add_skin(Motion& m, const Mesh& mesh, rt_u32 number, rt_u32 method) {
    Skin skin;
    skin.mesh = number;
    skin.method = method;
    skin.root = RT_NONE;
    skin.first_bone = static_cast<rt_u32>(m.bones.size());
    skin.bone_count = kBones;
    skin.first_weight = m.weights.size();
    m.bones.resize(m.bones.size() + kBones);
    for (rt_u32 v = 0; v < mesh.vertex_count; ++v)
        for (rt_u32 b = 0; v % 10 != 0 && b < kBones; ++b)
            if (happens(0.6)) m.weights.push_back({v, b, float(any(0.01, 1))});
    skin.weight_count = m.weights.size() - skin.first_weight;
    skin.has_shares = method == RT_SKIN_BLENDED;
    skin.first_share = m.shares.size();
    for (rt_u32 v = 0; skin.has_shares && v < mesh.vertex_count; ++v) m.shares.push_back(float(any(0, 1)));
    m.skins.push_back(skin);
}

ScenePtr deforming_scene() {
    static const ScenePtr scene = [] {
        Scene s = scene_of(torus(1, 0.3, 24, 16));
        s.instances.clear();
        for (rt_u32 m = 1; m < kMeshes; ++m) add_mesh(s, torus(1, 0.3, 24 + m, 30));
        for (rt_u32 m = 0; m < kMeshes; ++m) {
            place(s, m, moved_to(3 * float(m), 0, 0));
            s.instances.back().apart = true;
        }
        for (rt_u32 v = 0; v < s.vertex_count(); ++v)
            for (int k = 0; k < 3; ++k) s.normals.push_back(v % 7 == 0 ? 0 : float(any(-1, 1)));
        Motion& m = s.motion;
        for (const rt_u32 mesh : {kFrames, kAll}) add_frames(m, s.meshes[mesh], mesh);
        for (const rt_u32 mesh : {kAll, kMorphs}) add_morphs(m, s.meshes[mesh], mesh);
        add_skin(m, s.meshes[kLinear], kLinear, RT_SKIN_LINEAR);
        add_skin(m, s.meshes[kDual], kDual, RT_SKIN_DUAL_QUATERNION);
        add_skin(m, s.meshes[kBlended], kBlended, RT_SKIN_BLENDED);
        add_skin(m, s.meshes[kAll], kAll, RT_SKIN_BLENDED);
        return shared_scene(std::move(s));
    }();
    return scene;
}

Matrix any_matrix() {
    Quaternion q;
    for (double& x : q) x = any(-1, 1);
    Matrix m = rotation(unit(q)) * scaling({any(0.5, 2), any(0.5, 2), any(0.5, 2) * (happens(0.2) ? -1 : 1)});
    for (int i = 0; i < 3; ++i) m[4 * i + 3] = any(-2, 2);
    return m;
}

std::vector<Deformation> any_deformations() {
    const Motion& motion = deforming_scene()->motion;
    Deformers deformers;
    for (size_t i = 0; i < motion.morphs.size(); ++i) deformers.morph_weights.push_back(happens(0.2) ? 0 : any(-0.5, 1.5));
    deformers.nodes.resize(1);
    deformers.time_s = any(-0.5, 2.5);
    std::vector<Deformation> all = deformations(*deforming_scene(), deformers);
    for (Deformation& d : all) {
        for (Matrix& bone : d.bones) bone = any_matrix();
        d.unweighted = any_matrix();
    }
    return all;
}

class DeviceDeformerTest : public ::testing::TestWithParam<BuildForm> {
 protected:
    DeviceDeformerTest() : kernels_(Workbench::get().shared_device(), GetParam()), deformer_(kernels_, deforming_scene()) {
        positions_ = buffer_of(deforming_scene()->positions);
        normals_ = buffer_of(deforming_scene()->normals);
    }
    cl::Buffer buffer_of(const SharedArray<float>& values) {
        cl::Buffer buffer = kernels_.buffer(4 * values.size());
        queue().enqueueWriteBuffer(buffer, CL_TRUE, 0, 4 * values.size(), &values[0]);
        return buffer;
    }
    std::vector<float> download(const cl::Buffer& buffer) {
        std::vector<float> values(deforming_scene()->positions.size());
        queue().enqueueReadBuffer(buffer, CL_TRUE, 0, 4 * values.size(), values.data());
        return values;
    }
    Queue& queue() { return kernels_.device().queue(); }
    void make(const std::vector<Deformation>& deformations) {
        std::vector<const Deformation*> meshes;
        for (const Deformation& d : deformations) meshes.push_back(&d);
        deformer_.deform(meshes, positions_, normals_);
    }
    // Of one mesh.
    static void expect_same(const std::vector<float>& there, rt_u32 mesh, const std::vector<float>& expected) {
        const size_t first = 3 * size_t(deforming_scene()->meshes[mesh].first_vertex);
        for (size_t i = 0; i < expected.size(); ++i)
            ASSERT_EQ(there[first + i], expected[i]) << "mesh " << mesh << ", vertex " << i / 3;
    }

    BuildKernels kernels_;
    DeviceDeformer deformer_;
    cl::Buffer positions_, normals_;
};

TEST_P(DeviceDeformerTest, MakesTheVerticesOfTheHost) {
    for (int round = 0; round < 5; ++round) {
        SCOPED_TRACE(round);
        const std::vector<Deformation> all = any_deformations();
        ASSERT_EQ(all.size(), size_t(kMeshes - 1));
        make(all);
        const std::vector<float> positions = download(positions_), normals = download(normals_);
        for (const Deformation& d : all) {
            const PosedMesh expected = deformed(*deforming_scene(), d);
            expect_same(positions, d.mesh, expected.positions);
            expect_same(normals, d.mesh, expected.normals);
        }
    }
}

TEST_P(DeviceDeformerTest, OnlyMeshesThatAreAskedForAreMade) {
    const std::vector<Deformation> first = any_deformations(), second = any_deformations();
    make(first);
    make({second[1], second[4]});
    const std::vector<float> positions = download(positions_);
    for (size_t i = 0; i < first.size(); ++i)
        expect_same(positions, first[i].mesh, deformed(*deforming_scene(), i == 1 || i == 4 ? second[i] : first[i]).positions);
    expect_same(positions, kStill, stored_mesh(*deforming_scene(), kStill).positions);
}

INSTANTIATE_TEST_SUITE_P(, DeviceDeformerTest, ::testing::Values(BuildForm::groups, BuildForm::serial),
                         [](const auto& info) { return info.param == BuildForm::groups ? "groups" : "serial"; });

// A structure that follows poses without vertices has the bytes of one that the host moves to whole poses.
TEST(DeviceMoverOfPosesWithoutVertices, GivesTheBytesOfTheHost) {
    Progress progress;
    const ScenePtr scene = deforming_scene();
    const auto built = build(scene, *Workbench::get().plugins().accel("bvh4"));
    Settings settings;
    settings.lanes = 1;
    Device& device = const_cast<Device&>(Workbench::get().device());
    const auto prepared = prepare_queries(device, scene, built, settings, progress);
    DeviceMover motion(Workbench::get().shared_device(), scene, built, prepared->on_device, scene);
    ASSERT_TRUE(motion.can_deform());
    DeviceMover without(Workbench::get().shared_device(), scene, built, prepared->on_device);
    HostMover host(scene, built);
    Pose pose = pose_at_rest(*scene);
    const auto expect_leaves = [&](const Pose& given, const Pose& whole) {
        const MovedOnDevice moved = motion.move(given);
        ASSERT_TRUE(moved.on_device) << moved.why;
        const auto expected = host.move(whole, progress).accel;
        std::string leaves(expected->leaves.bytes(), 0);
        device.queue().enqueueReadBuffer(moved.on_device->moving().leaves, CL_TRUE, 0, leaves.size(), &leaves[0]);
        const auto* const words = static_cast<const float*>(expected->leaves.data());
        for (size_t i = 0; i < leaves.size() / 4; ++i) {
            float word;
            std::memcpy(&word, &leaves[4 * i], 4);
            ASSERT_TRUE(word == words[i] || std::memcmp(&word, &words[i], 4) == 0) << "leaf " << i / 12;
        }
    };
    for (int round = 0; round < 4; ++round) {
        SCOPED_TRACE(round);
        pose.meshes.clear();
        pose.deformations = any_deformations();
        EXPECT_NE(without.move(pose).why.find("the vertices of mesh 1 are missing"), std::string::npos);
        Pose whole = pose;
        add_vertices(*scene, whole);
        EXPECT_EQ(left_out(pose, kDual), &pose.deformations[kDual - 1]);
        EXPECT_EQ(left_out(whole, kDual), nullptr);
        expect_leaves(round == 2 ? whole : pose, whole);  // in between vertices are sent
    }
    EXPECT_EQ(motion.move(pose).refitted, 0u) << "nothing has moved";
    pose.deformations.clear();
    expect_leaves(pose, pose);
}

// Models of the shared folder: from files to the device.
TEST(DeviceDeformerModels, FollowTheirClips) {
    for (const char* name : {"gltf/CesiumMan.glb", "gltf/SimpleMorph.gltf", "fbx/maya_cache_sine_7500_binary.fbx",
                             "fbx/maya_blend_inbetween_7500_binary.fbx"}) {
        CLARITY_SHARED_OR_SKIP(path, std::string("scenes/") + name);
        SCOPED_TRACE(name);
        const ScenePtr scene = load_scene(path);
        const ClipInfo clip = clips(*scene).at(0);
        BuildKernels kernels(Workbench::get().shared_device());
        DeviceDeformer deformer(kernels, scene);
        cl::Buffer positions = kernels.buffer(4 * scene->positions.size()), normals = kernels.buffer(4 * scene->normals.size());
        size_t compared = 0;
        for (const double share : {0.0, 0.3, 0.9}) {
            const Pose pose = evaluate(*scene, clip.name, clip.begin_s + share * (clip.end_s - clip.begin_s));
            std::vector<const Deformation*> meshes;
            for (const Deformation& d : pose.deformations) meshes.push_back(&d);
            deformer.deform(meshes, positions, normals);
            for (const PosedMesh& mesh : pose.meshes) {
                std::vector<float> there(mesh.positions.size());
                kernels.device().queue().enqueueReadBuffer(positions, CL_TRUE, 12 * scene->meshes[mesh.mesh].first_vertex,
                                                           4 * there.size(), there.data());
                ASSERT_EQ(there, mesh.positions);
                compared += there.size();
            }
        }
        EXPECT_GT(compared, 0u);
    }
}

}  // namespace
}  // namespace clarity::test
