#include "moving.hpp"

#include <cmath>
#include <vector>

#include "rt_plugin.hpp"

namespace test_importer {
namespace {

struct Moving {
    const rt_scene_sink& sink;
    const std::string& fault;

    bool is(const char* what) const { return fault == what; }

    rt_u32 node(rt_u32 parent, const char* name) const {
        rt_node_desc node{};
        node.struct_bytes = sizeof node;
        node.parent = is("parent") ? 9 : parent;
        node.name = name;
        node.rotation_order = is("order") ? 77 : rt_u32(RT_ROTATE_XYZ);
        for (double& s : node.scale) s = 1;
        if (is("node nan")) node.translation[1] = std::nan("");
        return rt::id(sink.node(sink.ctx, &node));
    }
    rt_u32 clip() const {
        rt_clip_desc clip{};
        clip.struct_bytes = sizeof clip;
        clip.name = "walk";
        clip.begin_s = 1;
        clip.end_s = is("clip nan") ? std::nan("") : 3;
        clip.fps = 25;
        return rt::id(sink.clip(sink.ctx, &clip));
    }
    void channel(rt_u32 clip, rt_u32 moves, rt_u32 target, double from, double to) const {
        std::vector<double> times = {1, 3}, values = {from, to};
        std::vector<uint8_t> spans = {RT_SPAN_LINEAR, uint8_t(is("span") ? 9 : RT_SPAN_LINEAR)};
        if (is("key nan")) values[1] = std::nan("");
        if (is("key order")) times[1] = 0;
        rt_channel_desc channel{};
        channel.struct_bytes = sizeof channel;
        channel.clip = is("clip id") ? 0 : clip;
        channel.layer = is("layer") ? 1 : 0;
        channel.moves = is("moves") ? 99 : moves;
        channel.target = is("target") ? 40 : target;
        channel.component = is("component") ? 7 : 0;
        channel.key_count = is("no keys") ? 0 : 2;
        channel.times_s = times.data();
        channel.values = values.data();
        channel.spans = spans.data();
        if (is("quaternion")) channel.component = RT_ALL_COMPONENTS;
        if (sink.channel(sink.ctx, &channel) != RT_OK) throw rt::Stopped();
    }
    rt_u32 mesh() const {
        static const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        static const rt_u32 indices[3] = {0, 1, 2};
        rt_mesh mesh{};
        mesh.struct_bytes = sizeof mesh;
        mesh.material = RT_NONE;
        mesh.positions = corners;
        mesh.vertex_count = 3;
        mesh.position_stride = 12;
        mesh.indices = indices;
        mesh.index_count = 3;
        mesh.face_count = 1;
        return rt::id(sink.mesh(sink.ctx, &mesh));
    }
    void skin(rt_u32 mesh, rt_u32 bone_node) const {
        rt_bone bone{};
        bone.node = is("bone node") ? 9 : bone_node;
        for (int i = 0; i < 3; ++i) bone.bone_from_mesh[5 * i] = 1;
        rt_weight weights[2] = {{0, rt_u32(is("bone") ? 5 : 0), 1}, {1, 0, 1}};
        if (is("weight vertex")) weights[1].vertex = 3;
        if (is("weight nan")) weights[1].weight = std::nanf("");
        rt_skin_desc skin{};
        skin.struct_bytes = is("skin bytes") ? 16 : rt_u32(sizeof skin);
        skin.mesh = is("skin mesh") ? 4 : mesh;
        skin.bone_count = 1;
        skin.bones = &bone;
        skin.weights = weights;
        skin.weight_count = 2;
        if (sink.skin(sink.ctx, &skin) != RT_OK) throw rt::Stopped();
        if (is("two skins") && sink.skin(sink.ctx, &skin) != RT_OK) throw rt::Stopped();
    }
    rt_u32 morph(rt_u32 mesh) const {
        const float offset[3] = {0, 0, is("morph nan") ? std::nanf("") : 1};
        const rt_u32 vertex = is("morph vertex") ? 3 : 2;
        rt_morph_target target{};
        target.weight = 1;
        target.vertices = &vertex;
        target.count = 1;
        target.positions = offset;
        rt_morph_desc morph{};
        morph.struct_bytes = sizeof morph;
        morph.mesh = mesh;
        morph.targets = &target;
        morph.target_count = 1;
        return rt::id(sink.morph(sink.ctx, &morph));
    }
    void frames(rt_u32 mesh) const {
        const double times[2] = {1, is("frame order") ? 0.0 : 3};
        const float positions[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0};
        rt_vertex_frames frames{};
        frames.struct_bytes = sizeof frames;
        frames.mesh = mesh;
        frames.frame_count = 2;
        frames.times_s = times;
        frames.positions = positions;
        if (sink.vertex_frames(sink.ctx, &frames) != RT_OK) throw rt::Stopped();
    }
    void all() const {
        const rt_u32 root = node(0, "root"), hand = node(root, "hand"), id = mesh();
        rt_instance_desc placed = rt::instance(id, "triangle");
        placed.node = is("instance node") ? 9 : is("unhung") ? 0 : hand;
        rt::id(sink.instance(sink.ctx, &placed));
        skin(id, hand);
        const rt_u32 bend = morph(id);
        frames(id);
        const rt_u32 walk = clip();
        channel(walk, RT_MOVES_TRANSLATION, root, 0, 10);
        channel(walk, RT_MOVES_MORPH, bend, 0, 1);
    }
};

}  // namespace

int32_t moving(const rt_host& host, const rt_scene_sink& sink, const std::string& fault) {
    if (!RT_HAS(&sink, rt_scene_sink, vertex_frames)) return host.fail(host.ctx, "the host does not take motion");
    try {
        Moving{sink, fault}.all();
    } catch (const rt::Stopped&) {
        return RT_FAILED;
    }
    return RT_OK;
}

}  // namespace test_importer
