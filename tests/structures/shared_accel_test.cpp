// shared_accel_test.cpp -- a structure that another process has built and that lies in a file in memory.
#include "structures/shared_accel.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.hpp"
#include "support/scenes.hpp"
#include "support/workbench.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

std::vector<char> content_of(const MemoryFile& file) {
    std::vector<char> all(file.bytes());
    file.read_at(0, all.data(), all.size());
    return all;
}

std::string failure_of(const MemoryFile& file) {
    try {
        map_accel(file, Workbench::get().plugins());
        return {};
    } catch (const Error& e) {
        return e.what();
    }
}

// Shapes of all kinds, and meshes that are placed several times, with every structure.
TEST(SharedAccel, IsTheStructureThatWasWritten) {
    Workbench& bench = Workbench::get();
    Progress progress;
    for (const char* name : {"scenes/primitives.scene", "scenes/shapes.scene"}) {
        const ScenePtr scene = load_scene(source_file(name));
        for (const rt_plugin* plugin : bench.plugins().accels()) {
            SCOPED_TRACE(std::string(name) + ", " + plugin->id);
            const Settings settings = make_settings({{"accel", plugin->id}});
            const Preparer preparer(bench.plugins(), bench.shared_device());
            const auto built = preparer.builder(settings)(*scene, progress);
            MemoryFile file, again;
            write_accel(file, *built);
            EXPECT_TRUE(file.sealed());
            const auto mapped = map_accel(file, bench.plugins());
            EXPECT_TRUE(preparer.asks_for(*mapped, settings));
            ASSERT_EQ(mapped->slots.size(), built->slots.size());
            for (size_t s = 0; s < built->slots.size(); ++s) EXPECT_EQ(mapped->slots[s].count, built->slots[s].count);
            EXPECT_EQ(mapped->defines, built->defines);
            EXPECT_EQ(mapped->stats, built->stats);
            EXPECT_EQ(mapped->scene.bounds.max, built->scene.bounds.max);
            write_accel(again, *mapped);
            EXPECT_EQ(content_of(again), content_of(file)) << "and so does the rest";
        }
    }
}

TEST(SharedAccel, GivesThePictureOfTheStructureThatWasBuilt) {
    Workbench& bench = Workbench::get();
    Progress progress;
    const ScenePtr scene = load_scene(source_file("scenes/shapes.scene"));
    for (const std::string& accel : bench.fast_accels()) {
        const Settings settings = make_settings({{"accel", accel}, {"size", "64x48"}});
        const View view = make_view(*scene, 4.0f / 3);
        const ByteImage expected = bench.display(scene, settings, view);
        MemoryFile file;
        write_accel(file, *bench.prepare(scene, settings)->accel);
        Preparer preparer(bench.plugins(), bench.shared_device());
        auto mapped = map_accel(file, bench.plugins());
        const auto prepared = preparer.prepare(scene, settings, progress, std::move(mapped));
        bench.frames().trace(*prepared, settings, view, 0, true, progress);
        EXPECT_TRUE(bench.frames().read_display(settings).pixels == expected.pixels) << accel;
    }
}

TEST(SharedAccel, DamageIsRefused) {
    Workbench& bench = Workbench::get();
    Progress progress;
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const Preparer preparer(bench.plugins(), bench.shared_device());
    MemoryFile file;
    write_accel(file, *preparer.builder(make_settings({{"accel", "bvh2"}}))(*scene, progress));
    const std::vector<char> whole = content_of(file);
    EXPECT_EQ(failure_of(file), "");
    for (const size_t bytes : {size_t(1), size_t(127), size_t(128), size_t(300), whole.size() / 2, whole.size() - 129}) {
        MemoryFile cut;
        cut.write_at(0, whole.data(), bytes);
        cut.seal();
        EXPECT_NE(failure_of(cut).find("holds no structure"), std::string::npos) << bytes << ": " << failure_of(cut);
    }
    std::vector<char> other = whole;
    const auto id = std::search(other.begin(), other.end(), whole.begin() + 8, whole.begin() + 12);  // behind its length
    *id = 'x';
    MemoryFile unknown;
    unknown.write_at(0, other.data(), other.size());
    unknown.seal();
    EXPECT_NE(failure_of(unknown).find("accel xvh2"), std::string::npos) << failure_of(unknown);
}

}  // namespace
