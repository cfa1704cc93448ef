// geometry_cache_test.cpp -- each kind of file that has the vertices of a mesh at several times, written here byte by byte.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "fbx_model.hpp"
#include "scene/motion/pose.hpp"

namespace clarity::test {
namespace {

using Floats = std::vector<float>;

template <class T>
std::string bytes_of(T value, bool big_endian) {
    std::string out(sizeof value, '\0');
    std::memcpy(out.data(), &value, sizeof value);
    return big_endian ? std::string(out.rbegin(), out.rend()) : out;
}

// The square of geometry(1), with its corner at (x, 0, 0) in place of the origin.
Floats square(float x) {
    return {x, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
}

// Chunks of Maya's caches. `wide`: those of .mcx files.
struct Chunks {
    bool wide = false, doubles = false;
    std::string chunk(const std::string& name, const std::string& data) const {
        const size_t pad = wide ? 8 : 4;
        const std::string size =
            wide ? std::string(4, '\0') + bytes_of(uint64_t(data.size()), true) : bytes_of(uint32_t(data.size()), true);
        return name + size + data + std::string(name.substr(0, 3) == "FOR" ? 0 : (pad - data.size() % pad) % pad, '\0');
    }
    std::string group(const std::string& content) const { return chunk(wide ? "FOR8" : "FOR4", content); }
    std::string head() const {
        return group("CACH" + chunk("VRSN", std::string("0.1\0", 4)) + chunk("STIM", bytes_of(int32_t(0), true)) +
                     chunk("ETIM", bytes_of(int32_t(500), true)));
    }
    // time: in ticks; below 0: the frame does not say. The channel before the wanted one has values that must not be taken.
    std::string frame(int32_t time, const Floats& positions) const {
        std::string values;
        for (const float x : positions) values += doubles ? bytes_of(double(x), true) : bytes_of(x, true);
        const auto channel = [&](const std::string& name, const std::string& data) {
            return chunk("CHNM", name + '\0') + chunk("SIZE", bytes_of(uint32_t(positions.size() / 3), true)) +
                   chunk(doubles ? "DVCA" : "FVCA", data);
        };
        return group("MYCH" + (time < 0 ? "" : chunk("TIME", bytes_of(time, true))) + channel("other", "none") +
                     channel("shape", values));
    }
};

std::string description(const std::string& type, const std::string& format, const std::string& range = "0-500") {
    return "<?xml version=\"1.0\"?>\n<Autodesk_Cache_File>\n<cacheType Type=\"" + type + "\" Format=\"" + format +
           "\"/>\n<time Range=\"" + range +
           "\"/>\n<cacheTimePerFrame TimePerFrame=\"250\"/>\n<Channels>\n<channel0 ChannelName=\"shape\"/>\n</Channels>\n"
           "</Autodesk_Cache_File>\n";
}

std::string point_cache(uint32_t vertices, float first, float step, uint32_t samples) {
    std::string out = std::string("POINTCACHE2\0", 12) + bytes_of(int32_t(1), false) + bytes_of(vertices, false) +
                      bytes_of(first, false) + bytes_of(step, false) + bytes_of(samples, false);
    for (uint32_t s = 0; s < samples; ++s) {
        for (const float x : square(-1 - float(s))) out += bytes_of(x, false);
    }
    return out;
}

class GeometryCache : public FbxForms {
 protected:
    Scene scene_with(const std::string& cache) {
        return import(
            {geometry(1), model(2, "A"),
             node("Deformer", {whole(3), text("Deformer::D"), text("VertexCacheDeformer")},
                  {node("Properties70", {}, {word("ChannelName", "shape")})}),
             node("Cache", {whole(4), text("Cache::C"), text("")}, {node("Properties70", {}, {word("CacheFileName", cache)})})},
            {link(2, 0), link(1, 2), link(3, 1), link(4, 3)});
    }
    // The frames are at 0, 1/24 and 2/24 s, with the square's first corner at x = -1, -2 and -3.
    void expect_motion(const std::string& cache, double frame_s = 250 / 6000.) {
        const Scene scene = scene_with(cache);
        EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
        ASSERT_EQ(scene.motion.frames.size(), 1u);
        EXPECT_EQ(scene.motion.frames[0].frame_count, 3u);
        for (const double frame : {0.0, 0.5, 1.0, 2.0, 9.0}) {
            const Pose pose = evaluate(scene, "", frame * frame_s);
            ASSERT_EQ(pose.meshes.size(), 1u);
            EXPECT_NEAR(pose.meshes[0].positions[0], -1 - std::min(frame, 2.0), 1e-5) << "frame " << frame;
            EXPECT_NEAR(pose.meshes[0].positions[9], 0, 1e-6);
        }
    }
    // Damage leaves the mesh at rest, with one line that says why.
    void expect_warning(const std::string& cache, const std::string& why) {
        const Scene scene = scene_with(cache);
        ASSERT_EQ(scene.warnings.size(), 1u);
        EXPECT_NE(scene.warnings[0].find("the geometry cache '" + cache.substr(0, 40) + "'"), std::string::npos)
            << scene.warnings[0];
        EXPECT_NE(scene.warnings[0].find(why), std::string::npos) << scene.warnings[0];
        EXPECT_EQ(scene.warnings[0].find('\n'), std::string::npos);
        EXPECT_TRUE(scene.motion.frames.empty());
        EXPECT_EQ(scene.bounds().min[0], 0);
    }
};
INSTANTIATE_TEST_SUITE_P(Forms, GeometryCache, testing::Values(FbxForm{true, false, false, 7400}), fbx_form_name);

TEST_P(GeometryCache, MovesAMeshByOneFileOfMaya) {
    for (const bool wide : {false, true}) {
        for (const bool doubles : {false, true}) {
            SCOPED_TRACE(std::string(wide ? "mcx" : "mc") + (doubles ? ", doubles" : ", floats"));
            const Chunks chunks{wide, doubles};
            std::string all = chunks.head();
            for (int frame = 0; frame < 3; ++frame) all += chunks.frame(250 * frame, square(-1 - float(frame)));
            folder_.write(wide ? "walk.mcx" : "walk.mc", all);
            folder_.write("walk.xml", description("OneFile", wide ? "mcx" : "mc"));
            expect_motion("walk.xml");
        }
    }
}

TEST_P(GeometryCache, MovesAMeshByOneFileOfMayaForEachFrame) {
    for (const bool wide : {false, true}) {
        SCOPED_TRACE(wide ? "mcx" : "mc");
        const Chunks chunks{wide, false};
        for (int frame = 0; frame < 3; ++frame) {
            folder_.write("walkFrame" + std::to_string(frame) + (wide ? ".mcx" : ".mc"),
                          chunks.head() + chunks.frame(-1, square(-1 - float(frame))));
        }
        folder_.write("walk.xml", description("OneFilePerFrame", wide ? "mcx" : "mc"));
        expect_motion("walk.xml");
    }
}

TEST_P(GeometryCache, MovesAMeshByAPointCache) {
    folder_.write("walk.pc2", point_cache(4, 0, 1, 3));
    expect_motion("walk.pc2", 1 / 30.);  // the scene has 30 frames a second
    folder_.write("half.pc2", point_cache(4, 0, 0.5f, 3));
    expect_motion("half.pc2", 0.5 / 30);
}

TEST_P(GeometryCache, SaysWhatIsWrongWithAFileOfMaya) {
    const Chunks chunks;
    const std::string good = chunks.head() + chunks.frame(0, square(-1)) + chunks.frame(250, square(-2));
    folder_.write("walk.xml", description("OneFile", "mc"));
    const auto expect = [&](const std::string& content, const std::string& why) {
        folder_.write("walk.mc", content);
        expect_warning("walk.xml", why);
    };
    expect("", "byte 0: found no chunk FOR4 or FOR8");
    expect("RIFF" + good.substr(4), "byte 0: found no chunk FOR4 or FOR8");
    expect(good.substr(0, good.size() - 5), "a chunk reaches beyond its file or block");
    expect(good + "FOR", "a chunk reaches beyond its file or block");
    expect(chunks.head() + chunks.frame(0, Floats(9)), "a frame has 3 vertices; the mesh has 4");
    expect(chunks.head() + chunks.frame(250, square(0)) + chunks.frame(0, square(0)), "its times do not increase");
    expect(chunks.head(), "has no channel 'shape'");
    Floats odd = square(0);
    odd[4] = std::numeric_limits<float>::quiet_NaN();
    expect(chunks.head() + chunks.frame(0, odd), "values that are no finite numbers");
}

TEST_P(GeometryCache, SaysWhatIsWrongWithADescription) {
    const auto expect = [&](const std::string& content, const std::string& why) {
        folder_.write("walk.xml", content);
        expect_warning("walk.xml", why);
    };
    expect_warning("nothing.xml", "cannot open the file");
    expect("no text of ours", "its description has no element <cacheType");
    expect(description("OneFile", "abc"), "its format is 'abc'; expected mc or mcx");
    expect(description("OneFile", "mc"), "its file walk.mc: cannot open the file");
    expect(description("OneFilePerFrame", "mc"), "its file walkFrame0.mc: cannot open the file");
    expect(description("OneFilePerFrame", "mc", "500-0"), "its range of time '500-0' makes no sense");
    expect(description("OneFilePerFrame", "mc", "0-999999999999"), "its range of time '0-999999999999' makes no sense");
}

TEST_P(GeometryCache, SaysWhatIsWrongWithAPointCache) {
    const auto expect = [&](const std::string& content, const std::string& why) {
        folder_.write("walk.pc2", content);
        expect_warning("walk.pc2", why);
    };
    const std::string good = point_cache(4, 0, 1, 3);
    expect(good.substr(0, 20), "byte 0: it ends within its head");
    expect(point_cache(5, 0, 1, 3), "byte 16: it has 5 vertices; the mesh has 4");
    expect(good.substr(0, good.size() - 1), "byte 28: it has fewer than its 3 samples");
    expect(point_cache(4, 0, 0, 3), "byte 20: its first frame or its step makes no sense");
    expect(point_cache(4, std::numeric_limits<float>::infinity(), 1, 3), "byte 20: its first frame or its step makes no sense");
}

}  // namespace
}  // namespace clarity::test
