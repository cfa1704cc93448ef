// gltf_motion_test.cpp -- what the importer tells the host of nodes, clips, skins and morphs. The importer's own code is
// linked, so that the calls can be looked at.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>

#include "../../../plugins/importers/gltf/load.hpp"
#include "measure.hpp"
#include "rt_plugin.hpp"

namespace clarity::test {
namespace {

struct Channel {
    rt_u32 clip, moves, target, component;
    std::vector<double> times, values, handles;
    std::vector<uint8_t> spans;
};

// Keeps what an importer passes.
struct Recorder {
    Recorder() {
        host.struct_bytes = sizeof host;
        host.ctx = sink.ctx = this;
        host.fail = [](void*, const char*) { return int32_t(RT_FAILED); };
        host.log = [](void*, int32_t, const char*) {};
        host.progress = [](void*, float) { return 1; };
        sink.struct_bytes = sizeof sink;
        sink.texture = [](void*, const rt_texture_desc*) { return RT_NONE; };
        sink.material = [](void*, const rt_material_desc*) { return rt_u32(0); };
        sink.mesh = [](void* ctx, const rt_mesh*) { return self(ctx).meshes++; };
        sink.instance = [](void* ctx, const rt_instance_desc* d) {
            self(ctx).instances.push_back(*d);
            return rt_u32(0);
        };
        sink.light = [](void*, const rt_light_desc*) { return rt_u32(0); };
        sink.camera = [](void*, const rt_camera*) { return rt_u32(0); };
        sink.info = [](void*, const rt_scene_info*) {};
        sink.warn = [](void* ctx, const char* text) { self(ctx).warnings.push_back(text); };
        sink.node = [](void* ctx, const rt_node_desc* d) {
            self(ctx).nodes.push_back(*d);
            return rt_u32(self(ctx).nodes.size());
        };
        sink.clip = [](void* ctx, const rt_clip_desc* d) {
            self(ctx).clips.push_back(*d);
            return rt_u32(self(ctx).clips.size());
        };
        sink.channel = [](void* ctx, const rt_channel_desc* d) {
            const size_t n = d->key_count * (d->component == RT_ALL_COMPONENTS ? 4 : 1);
            Channel channel{
                d->clip, d->moves, d->target, d->component, {d->times_s, d->times_s + d->key_count}, {d->values, d->values + n},
                {},      {}};
            if (d->handles) channel.handles.assign(d->handles, d->handles + 4 * n);
            if (d->spans) channel.spans.assign(d->spans, d->spans + d->key_count);
            self(ctx).channels.push_back(channel);
            return int32_t(RT_OK);
        };
        sink.morph = [](void* ctx, const rt_morph_desc* d) {
            const rt_morph_target& t = d->targets[0];
            self(ctx).morph_vertices.emplace_back(t.vertices, t.vertices + t.count);
            self(ctx).morph_positions.emplace_back(t.positions, t.positions + 3 * t.count);
            return rt_u32(self(ctx).morph_vertices.size());
        };
        sink.skin = [](void* ctx, const rt_skin_desc* d) {
            self(ctx).bones.assign(d->bones, d->bones + d->bone_count);
            self(ctx).weights.assign(d->weights, d->weights + d->weight_count);
            return int32_t(RT_OK);
        };
    }
    static Recorder& self(void* ctx) { return *static_cast<Recorder*>(ctx); }
    void load(const std::string& bytes) {
        const gltf_import::Document document(bytes, "");
        gltf_import::load_document(document, &host, sink);
    }

    rt_host host{};
    rt_scene_sink sink{};
    rt_u32 meshes = 0;
    std::vector<rt_instance_desc> instances;
    std::vector<rt_node_desc> nodes;
    std::vector<rt_clip_desc> clips;
    std::vector<Channel> channels;
    std::vector<std::vector<rt_u32>> morph_vertices;
    std::vector<std::vector<float>> morph_positions;
    std::vector<rt_bone> bones;
    std::vector<rt_weight> weights;
    std::vector<std::string> warnings;
};

// A buffer of float and integers for a file below, as percent-encoded data.
std::string data_uri(const std::string& bytes) {
    std::string out = "data:application/octet-stream,";
    for (const char c : bytes) {
        char code[4];
        std::snprintf(code, sizeof code, "%%%02X", static_cast<unsigned char>(c));
        out += code;
    }
    return out;
}

nlohmann::json accessor(size_t view, size_t count, const char* type, int component_type = 5126) {
    return {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}};
}

// A triangle on a bone, with a morph target, and an animation with a cubic rotation, a stepped scale and linear weights.
nlohmann::json everything() {
    const std::string parts[] = {
        floats({0, 0, 0, 1, 0, 0, 0, 1, 0}),                       // 0 positions
        std::string("\0\0\0\0\0\0\0\0\0\0\0\0", 12),               // 1 joints
        floats({2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}),              // 2 weights
        floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}),  // 3 inverse bind matrix, column-major
        floats({0, 0, 0, 0, 0, 3, 0, 0, 0}),                       // 4 morph target
        floats({1, 4}),                                            // 5 times
        floats({0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 3, 0, 0, 0, 6, 0, 0, 0, 1, 0, 0, 0, 0, 0}),  // 6 cubic rotation
        floats({1, 1, 1, 2, 2, 2}),                                                        // 7 scales
        floats({0, 0.5f}),                                                                 // 8 weights of the morph
    };
    nlohmann::json file = {
        {"asset", {{"version", "2.0"}}},
        {"scenes", {{{"nodes", {0, 1}}}}},
        {"nodes",
         {{{"mesh", 0}, {"skin", 0}, {"name", "body"}},
          {{"name", "root"}, {"children", {2}}, {"translation", {1, 2, 3}}},
          {{"name", "tip"}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 9, 8, 7, 1}}}}},
        {"skins", {{{"joints", {2}}, {"inverseBindMatrices", 3}}}},
        {"meshes",
         {{{"primitives",
            {{{"attributes", {{"POSITION", 0}, {"JOINTS_0", 1}, {"WEIGHTS_0", 2}}}, {"targets", {{{"POSITION", 4}}}}}}},
           {"weights", {0.25}}}}},
        {"accessors",
         {accessor(0, 3, "VEC3"), accessor(1, 3, "VEC4", 5121), accessor(2, 3, "VEC4"), accessor(3, 1, "MAT4"),
          accessor(4, 3, "VEC3"), accessor(5, 2, "SCALAR"), accessor(6, 6, "VEC4"), accessor(7, 2, "VEC3"),
          accessor(8, 2, "SCALAR")}},
        {"animations",
         {{{"name", "dance"},
           {"samplers",
            {{{"input", 5}, {"output", 6}, {"interpolation", "CUBICSPLINE"}},
             {{"input", 5}, {"output", 7}, {"interpolation", "STEP"}},
             {{"input", 5}, {"output", 8}}}},
           {"channels",
            {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}},
             {{"sampler", 1}, {"target", {{"node", 1}, {"path", "scale"}}}},
             {{"sampler", 2}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}}}};
    for (size_t i = 0; i < std::size(parts); ++i) {
        file["buffers"].push_back({{"byteLength", parts[i].size()}, {"uri", data_uri(parts[i])}});
        file["bufferViews"].push_back({{"buffer", i}, {"byteLength", parts[i].size()}});
    }
    return file;
}

TEST(GltfMotion, PassesNodesWithParentsFirst) {
    Recorder got;
    got.load(everything().dump());
    ASSERT_EQ(got.nodes.size(), 3u);
    EXPECT_EQ(got.nodes[1].parent, 0u);
    EXPECT_EQ(got.nodes[2].parent, 2u);
    EXPECT_EQ(got.nodes[1].translation[2], 3);
    EXPECT_EQ(got.nodes[1].rotation_order, rt_u32(RT_ROTATE_QUATERNION));
    EXPECT_EQ(got.nodes[2].after_scale[3], 9);  // the matrix, whose translation is its last column
    EXPECT_EQ(got.nodes[2].after_scale[11], 7);
    ASSERT_EQ(got.instances.size(), 1u);
    EXPECT_EQ(got.instances[0].node, 1u);
    EXPECT_EQ(got.instances[0].world_from_object[0], 1);
}

TEST(GltfMotion, PassesSkinsAndMorphs) {
    Recorder got;
    got.load(everything().dump());
    ASSERT_EQ(got.bones.size(), 1u);
    EXPECT_EQ(got.bones[0].node, 3u);
    EXPECT_EQ(got.bones[0].bone_from_mesh[3], 5);
    EXPECT_EQ(got.bones[0].bone_from_mesh[7], 6);
    ASSERT_EQ(got.weights.size(), 3u);
    EXPECT_EQ(got.weights[2].vertex, 2u) << "it has no weights, so it follows the first joint";
    EXPECT_EQ(got.weights[2].bone, 0u);
    EXPECT_EQ(got.weights[0].weight, 2);
    EXPECT_EQ(got.weights[1].vertex, 1u);
    ASSERT_EQ(got.morph_vertices.size(), 1u);
    EXPECT_EQ(got.morph_vertices[0], std::vector<rt_u32>{1});  // only the vertex that moves
    EXPECT_EQ(got.morph_positions[0], (std::vector<float>{0, 0, 3}));
}

TEST(GltfMotion, PassesChannelsAsBezierCurves) {
    Recorder got;
    got.load(everything().dump());
    ASSERT_EQ(got.clips.size(), 1u);
    EXPECT_EQ(got.clips[0].begin_s, 1);
    EXPECT_EQ(got.clips[0].end_s, 4);
    EXPECT_EQ(got.clips[0].fps, 0);
    ASSERT_EQ(got.channels.size(), 5u);
    const Channel& turn = got.channels[0];
    EXPECT_EQ(turn.component, RT_ALL_COMPONENTS);
    EXPECT_EQ(turn.target, 3u);
    EXPECT_EQ(turn.values, (std::vector<double>{0, 0, 0, 1, 0, 0, 1, 0}));
    ASSERT_EQ(turn.handles.size(), 32u);
    // Component z: the tangent out of the first key is 3 a second, the span lasts 3 s, and the tangent into the second key
    // is 6.
    EXPECT_EQ(std::vector<double>(&turn.handles[8], &turn.handles[12]), (std::vector<double>{0, 0, 1, 3}));
    EXPECT_EQ(std::vector<double>(&turn.handles[24], &turn.handles[28]), (std::vector<double>{1, 6, 0, 0}));
    EXPECT_EQ(turn.spans[0], RT_SPAN_CUBIC);
    for (rt_u32 k = 0; k < 3; ++k) {
        EXPECT_EQ(got.channels[1 + k].component, k);
        EXPECT_EQ(got.channels[1 + k].moves, rt_u32(RT_MOVES_SCALE));
        EXPECT_EQ(got.channels[1 + k].spans[0], RT_SPAN_STEP);
        EXPECT_EQ(got.channels[1 + k].values, (std::vector<double>{1, 2}));
    }
    EXPECT_EQ(got.channels[4].moves, rt_u32(RT_MOVES_MORPH));
    EXPECT_EQ(got.channels[4].target, 1u);
    EXPECT_TRUE(got.channels[4].spans.empty());
}

TEST(GltfMotion, ChecksJoints) {
    const auto refusal = [](const std::function<void(nlohmann::json&)>& edit) {
        nlohmann::json file = everything();
        edit(file);
        try {
            Recorder().load(file.dump());
        } catch (const gltf_import::Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(refusal([](auto& f) { f["buffers"][1]["uri"] = data_uri(std::string("\0\0\0\0\7\0\0\0\0\0\0\0", 12)); }),
              "meshes[0].primitives[0].attributes.JOINTS_0: found joint number 7 at vertex 1, expected one of the 1 joints of "
              "skins[0]");
    EXPECT_EQ(refusal([](auto& f) { f["skins"][0]["joints"] = {2, 1}; }),
              "skins[0].inverseBindMatrices: found 1 matrices, expected 2, one for each joint");
    EXPECT_EQ(refusal([](auto& f) { f["skins"][0]["joints"] = nlohmann::json::array(); }),
              "skins[0].joints: found no joint, expected one or more");
}

// A channel that is wrong is left out, with a warning of its place; the others are there.
TEST(GltfMotion, LeavesWrongChannelsOut) {
    const auto expect = [](const std::string& warning, size_t clips, size_t channels,
                           const std::function<void(nlohmann::json&)>& edit) {
        SCOPED_TRACE(warning);
        nlohmann::json file = everything();
        edit(file);
        Recorder got;
        got.load(file.dump());
        EXPECT_EQ(got.clips.size(), clips);
        EXPECT_EQ(got.channels.size(), channels);
        EXPECT_EQ(got.instances.size(), 1u);
        const auto is_it = [&](const std::string& w) { return w.find(warning) != std::string::npos; };
        EXPECT_TRUE(std::any_of(got.warnings.begin(), got.warnings.end(), is_it)) << got.warnings.at(0);
    };
    const auto channel = [](nlohmann::json& f, size_t i) -> nlohmann::json& { return f["animations"][0]["channels"][i]; };
    const auto sampler = [](nlohmann::json& f, size_t i) -> nlohmann::json& { return f["animations"][0]["samplers"][i]; };
    // All three samplers have the times of one accessor.
    expect(
        "animations[0].samplers[0].input: found the time 1.000000 s of key 1 after 4.000000 s, expected times that increase; "
        "the channel is left out",
        0, 0, [](auto& f) { f["buffers"][5]["uri"] = data_uri(floats({4, 1})); });
    expect("accessors[8].count: found 1, expected 2 for animations[0].samplers[2].output; the channel is left out", 1, 4,
           [](auto& f) { f["accessors"][8]["count"] = 1; });
    expect(
        "animations[0].channels[1].target.path: found 'color', expected 'translation', 'rotation', 'scale' or 'weights'; the "
        "channel is left out",
        1, 2, [&](auto& f) { channel(f, 1)["target"]["path"] = "color"; });
    expect("animations[0].channels[1].target: found no member 'node', expected the node that it moves; the channel", 1, 2,
           [&](auto& f) { channel(f, 1)["target"].erase("node"); });
    expect("animations[0].channels[1].target.node: found 7, expected the index of one of 3 nodes; the channel", 1, 2,
           [&](auto& f) { channel(f, 1)["target"]["node"] = 7; });
    expect("animations[0].channels[3].target: found a second channel for the scale of nodes[1], expected one; the channel", 1,
           5, [&](auto& f) { f["animations"][0]["channels"].push_back(channel(f, 1)); });
    expect("animations[0].channels[0].sampler: found 9, expected the index of one of 3 animations[0].samplers", 1, 4,
           [&](auto& f) { channel(f, 0)["sampler"] = 9; });
    expect("animations[0].samplers[1].interpolation: found 'SMOOTH'", 1, 2,
           [&](auto& f) { sampler(f, 1)["interpolation"] = "SMOOTH"; });
    expect("animations[0].samplers[1]: found no member 'output'", 1, 2, [&](auto& f) { sampler(f, 1).erase("output"); });
    expect("animations[0].channels[2]: found no member 'target'", 1, 4, [&](auto& f) { channel(f, 2).erase("target"); });
    expect("animations[0]: found no member 'samplers', expected it there; the animation is left out", 0, 0,
           [](auto& f) { f["animations"][0].erase("samplers"); });
    expect("animations[0].channels: found 5, expected an array; the animation is left out", 0, 0,
           [](auto& f) { f["animations"][0]["channels"] = 5; });
    expect("animations[0]: found no channel that moves something; the animation is left out", 0, 0,
           [](auto& f) { f["animations"][0]["channels"] = nlohmann::json::array(); });
    expect("animations[1].samplers: found", 1, 5, [](auto& f) {
        f["animations"].push_back(
            {{"samplers", "none"}, {"channels", nlohmann::json::array({f["animations"][0]["channels"][0]})}});
    });
}

TEST(GltfMotion, IgnoresSamplersThatNoChannelUses) {
    nlohmann::json file = everything();
    file["animations"][0]["samplers"].push_back({{"input", 6}, {"output", 77}});
    Recorder got;
    got.load(file.dump());
    EXPECT_EQ(got.channels.size(), 5u);
    EXPECT_EQ(got.warnings.size(), 1u) << "that of the vertex without weights";
    EXPECT_EQ(got.clips.at(0).end_s, 4);
}

// The host places what stands still (Gltf.PlacesWhatStandsStill).
TEST(GltfMotion, PassesNodesAlsoOfWhatStandsStill) {
    nlohmann::json file = everything();
    file.erase("animations");
    file.erase("skins");
    file["nodes"][0].erase("skin");
    file["nodes"][0]["translation"] = {4, 5, 6};
    file["meshes"][0]["primitives"][0].erase("targets");
    Recorder got;
    got.load(file.dump());
    ASSERT_EQ(got.nodes.size(), file["nodes"].size());
    ASSERT_EQ(got.instances.size(), 1u);
    ASSERT_NE(got.instances[0].node, 0u);
    EXPECT_EQ(got.nodes[got.instances[0].node - 1].translation[1], 5);
}

}  // namespace
}  // namespace clarity::test
