// Discovery of plugins: the order of folders, which plugin is used and which is shadowed, and which importer takes a file. The
// libraries are copies of the sound one of tests/bad_plugins under several names.
#include "plugin/registry.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/log.hpp"
#include "cli/commands.hpp"
#include "support/scratch.hpp"

namespace {

namespace fs = std::filesystem;
using clarity::PluginRecord;
using clarity::PluginRegistry;

const std::string kSound = std::string(TEST_PLUGINS) + "/sound.so";
const std::string kWrongAbi = std::string(TEST_PLUGINS) + "/wrong_abi.so";

class Registry : public testing::Test {
 protected:
    Registry() {
        // Exclude the user's own plugins and variable.
        environment_.set("XDG_DATA_HOME", scratch_.path("data"));
        environment_.set("CLARITY_PLUGIN_PATH", "");
        clarity::set_log_listener([this](clarity::LogLevel level, const std::string& text) {
            if (level >= clarity::LogLevel::warning) warnings_.push_back(text);
        });
    }
    ~Registry() override { clarity::set_log_listener({}); }

    // A separate library: a copy of the file, not a second name for it.
    std::string copy(const std::string& from, const std::string& to) {
        fs::create_directories(fs::path(scratch_.path(to)).parent_path());
        fs::copy_file(from, scratch_.path(to), fs::copy_options::overwrite_existing);
        return scratch_.path(to);
    }
    // Only the records below the scratch folder, because the program's own plugins are found as well.
    std::vector<PluginRecord> ours(const PluginRegistry& registry) const {
        std::vector<PluginRecord> list;
        for (const PluginRecord& record : registry.records())
            if (record.path.find(scratch_.path("")) == 0) list.push_back(record);
        return list;
    }
    bool warned(const std::string& words) const {
        for (const std::string& line : warnings_)
            if (line.find(words) != std::string::npos) return true;
        return false;
    }

    Scratch scratch_;
    Environment environment_;
    std::vector<std::string> warnings_;
};

// A structure that nothing can trace must not be chosen.
TEST_F(Registry, TreesNeedALayoutThatPacksThem) {
    const std::string folder = std::string(TEST_PLUGINS) + "/",
                      bvh2 = std::string(CLARITY_BUILD_DIR) + "/lib/clarity/plugins/accel/bvh2.so";
    const PluginRegistry registry = PluginRegistry::of(
        {folder + "tree_of_nobody.so", folder + "tree_of_sound.so", folder + "tree_of_bvh2.so", kSound, bvh2});
    ASSERT_EQ(registry.records().size(), 5u);
    EXPECT_EQ(registry.records()[0].plugin, nullptr);
    EXPECT_NE(registry.records()[0].why.find("layout 'nobody' was not found"), std::string::npos) << registry.records()[0].why;
    EXPECT_NE(registry.records()[0].why.find("name one of bvh2"), std::string::npos) << registry.records()[0].why;
    EXPECT_NE(registry.records()[1].why.find("layout 'sound' has no `pack`"), std::string::npos) << registry.records()[1].why;
    EXPECT_TRUE(warned("tree_of_nobody.so: its layout"));
    const rt_plugin* tree = registry.accel("tree_of_bvh2");
    ASSERT_NE(tree, nullptr) << registry.records()[2].why;
    EXPECT_EQ(&registry.layout_of(*tree), registry.accel("bvh2")) << "the order of the libraries does not matter";
    EXPECT_EQ(&registry.layout_of(*registry.accel("sound")), registry.accel("sound"));
}

TEST_F(Registry, OrderIsFilesThenVariableThenUserData) {
    const std::string user = copy(kSound, "data/clarity/plugins/a.so");
    const std::string second = copy(kSound, "two/b.so"), first_b = copy(kSound, "one/b.so"), first_a = copy(kSound, "one/a.so");
    const std::string named = copy(kSound, "named/z.so");
    environment_.set("CLARITY_PLUGIN_PATH", scratch_.path("one") + ":" + scratch_.path("two"));
    const PluginRegistry registry = PluginRegistry::discover({named});
    const std::vector<PluginRecord> records = ours(registry);
    const std::vector<std::string> expected = {named, first_a, first_b, second, user};
    ASSERT_EQ(records.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(records[i].path, expected[i]);
        EXPECT_NE(records[i].plugin, nullptr) << records[i].why;
        EXPECT_EQ(records[i].shadowed, i > 0) << "the first of an id wins";
    }
    EXPECT_EQ(registry.accel("sound"), records[0].plugin);
}

TEST_F(Registry, FindsByKindAndId) {
    environment_.set("CLARITY_PLUGIN_PATH", scratch_.path("one"));
    copy(kSound, "one/a.so");
    const PluginRegistry registry = PluginRegistry::discover();
    EXPECT_NE(registry.accel("sound"), nullptr);
    EXPECT_EQ(registry.importer("sound"), nullptr) << "it is no importer";
    EXPECT_EQ(registry.accel("soun"), nullptr);
    EXPECT_EQ(registry.accel(""), nullptr);
    std::vector<std::string> ids;
    for (const rt_plugin* plugin : registry.accels()) ids.push_back(plugin->id);
    EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
    EXPECT_EQ(std::count(ids.begin(), ids.end(), "sound"), 1);
}

TEST_F(Registry, FindsPluginsInSubfoldersByKind) {
    copy(kSound, "tree/accel/sound.so");
    environment_.set("CLARITY_PLUGIN_PATH", scratch_.path("tree"));
    EXPECT_EQ(ours(PluginRegistry::discover()).size(), 1u);
}

TEST_F(Registry, IgnoresOtherFilesThanLibraries) {
    scratch_.write("one/readme.txt", "text");
    scratch_.write("one/sound.so.bak", "text");
    fs::create_directories(scratch_.path("one/deeper"));
    copy(kSound, "one/deeper/hidden.so");
    environment_.set("CLARITY_PLUGIN_PATH", scratch_.path("one"));
    EXPECT_TRUE(ours(PluginRegistry::discover()).empty());
}

TEST_F(Registry, ARefusedLibraryIsListedAndLeavesItsIdFree) {
    const std::string bad = copy(kWrongAbi, "one/a.so"), text = scratch_.write("one/b.so", "text"),
                      good = copy(kSound, "one/c.so");
    environment_.set("CLARITY_PLUGIN_PATH", scratch_.path("one"));
    const PluginRegistry registry = PluginRegistry::discover();
    const std::vector<PluginRecord> records = ours(registry);
    ASSERT_EQ(records.size(), 3u);
    EXPECT_EQ(records[0].plugin, nullptr);
    EXPECT_NE(records[0].why.find("ABI version 3"), std::string::npos);
    EXPECT_EQ(records[1].plugin, nullptr);
    EXPECT_EQ(registry.accel("sound"), records[2].plugin);
    EXPECT_TRUE(warned(bad + ": ABI version 3"));
    EXPECT_TRUE(warned(text + ": "));
}

TEST_F(Registry, AMissingFolderOfTheVariableIsAWarning) {
    environment_.set("CLARITY_PLUGIN_PATH", scratch_.path("nowhere"));
    EXPECT_TRUE(ours(PluginRegistry::discover()).empty());
    EXPECT_TRUE(warned(scratch_.path("nowhere")));
    EXPECT_FALSE(warned(scratch_.path("data"))) << "a place that nobody named may be missing";
}

TEST_F(Registry, SymlinksAreFollowedAndAFileCountsOnce) {
    const std::string real = copy(kSound, "real/sound.so");
    fs::create_directories(scratch_.path("links"));
    fs::create_symlink(real, scratch_.path("links/a.so"));
    fs::create_symlink(scratch_.path("links"), scratch_.path("folder"));
    environment_.set("CLARITY_PLUGIN_PATH",
                     scratch_.path("folder") + ":" + scratch_.path("real") + ":" + scratch_.path("links"));
    const std::vector<PluginRecord> records = ours(PluginRegistry::discover());
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0].path, scratch_.path("folder/a.so"));
    EXPECT_NE(records[0].plugin, nullptr) << records[0].why;
}

TEST_F(Registry, ABrokenSymlinkIsRefusedAndNotFatal) {
    fs::create_directories(scratch_.path("one"));
    fs::create_symlink(scratch_.path("gone.so"), scratch_.path("one/a.so"));
    environment_.set("CLARITY_PLUGIN_PATH", scratch_.path("one"));
    const std::vector<PluginRecord> records = ours(PluginRegistry::discover());
    ASSERT_EQ(records.size(), 1u);
    EXPECT_NE(records[0].why.find("No such file"), std::string::npos) << records[0].why;
}

// As in PATH, an empty element could mean the working directory. Users do not expect that code is loaded from there.
TEST_F(Registry, NeverSearchesTheWorkingDirectory) {
    copy(kSound, "here/sound.so");
    const fs::path before = fs::current_path();
    fs::current_path(scratch_.path("here"));
    for (const char* path : {"", ":", "::"}) {
        environment_.set("CLARITY_PLUGIN_PATH", path);
        EXPECT_EQ(PluginRegistry::discover().accel("sound"), nullptr) << "'" << path << "'";
    }
    environment_.set("XDG_DATA_HOME", ".");
    fs::create_directories("clarity/plugins");
    copy(kSound, "here/clarity/plugins/sound.so");
    EXPECT_EQ(PluginRegistry::discover().accel("sound"), nullptr) << "a relative XDG_DATA_HOME";
    // A file that was named is loaded, also if it is a bare name, which dlopen would look up elsewhere.
    EXPECT_NE(PluginRegistry::discover({"sound.so"}).accel("sound"), nullptr);
    fs::current_path(before);
}

// ---- which importer takes a file -------------------------------------------------------------------------------------------

class ImporterChoice : public Registry {
 protected:
    ImporterChoice() {
        copy(std::string(TEST_PLUGINS) + "/by_name.so", "one/by_name.so");
        copy(std::string(TEST_PLUGINS) + "/by_content.so", "one/by_content.so");
        environment_.set("CLARITY_PLUGIN_PATH", scratch_.path("one"));
        registry_ = PluginRegistry::discover();
    }
    std::string choice(const std::string& path) const {
        const rt_plugin* plugin = registry_.importer_for(path);
        return plugin ? plugin->id : "none";
    }
    PluginRegistry registry_;
};

TEST_F(ImporterChoice, ByExtensionInUpperOrLowerCase) {
    EXPECT_EQ(choice(scratch_.write("a.shape", "")), "by_name");
    EXPECT_EQ(choice(scratch_.write("b.SHAPE", "text")), "by_name");
    EXPECT_EQ(choice(scratch_.path("missing.shape")), "by_name") << "the importer says best what is wrong with the file";
}

TEST_F(ImporterChoice, ContentComesBeforeTheExtension) {
    EXPECT_EQ(choice(scratch_.write("c.shape", "MAGIC and more")), "by_content");
    EXPECT_EQ(choice(scratch_.write("d.unknown", "MAGIC and more")), "by_content");
    EXPECT_EQ(choice(scratch_.write("noextension", "MAGIC")), "by_content");
}

TEST_F(ImporterChoice, NoneForUnknownFiles) {
    EXPECT_EQ(choice(scratch_.write("e.unknown", "text")), "none");
    EXPECT_EQ(choice(scratch_.write("shape", "text")), "none") << "a name is no extension";
    EXPECT_EQ(choice(scratch_.write("f.unknown", "MAYBE")), "none") << "too little certainty for a file of another name";
    EXPECT_EQ(choice(scratch_.path("missing.unknown")), "none");
    EXPECT_EQ(choice(scratch_.path("")), "none");
}

TEST_F(ImporterChoice, AProbeThatThrowsIsIgnored) {
    EXPECT_EQ(choice(scratch_.write("g.shape", "THROW")), "by_name");
    EXPECT_EQ(choice(scratch_.write("g.magic", "THROW")), "by_content");
    EXPECT_EQ(choice(scratch_.write("g.unknown", "THROW")), "none");
}

// // The command `clarity plugins`: its output about loaded, shadowed and refused libraries, as text and as JSON.

namespace fs = std::filesystem;

class PluginsCommand : public testing::Test {
 protected:
    PluginsCommand() {
        clarity::set_log_level(clarity::LogLevel::error);
        environment_.set("XDG_DATA_HOME", scratch_.path("data"));
        environment_.set("CLARITY_PLUGIN_PATH", scratch_.path("p"));
        fs::create_directories(scratch_.path("p"));
        for (const auto& [from, to] :
             {std::pair("sound.so", "p/a.so"), {"sound.so", "p/b.so"}, {"wrong_abi.so", "p/c.so"}, {"by_name.so", "p/d.so"}})
            fs::copy_file(fs::path(TEST_PLUGINS) / from, scratch_.path(to));
    }
    ~PluginsCommand() override { clarity::set_log_level(clarity::LogLevel::info); }

    static std::string output(bool json) {
        const clarity::PluginRegistry registry = clarity::PluginRegistry::discover();
        testing::internal::CaptureStdout();
        EXPECT_EQ(clarity::run_plugins(registry, json), 0);
        return testing::internal::GetCapturedStdout();
    }

    Scratch scratch_;
    Environment environment_;
};

TEST_F(PluginsCommand, JsonListsEveryLibrary) {
    const nlohmann::json json = nlohmann::json::parse(output(true));
    EXPECT_EQ(json["abi_version"], RT_ABI_VERSION);
    ASSERT_GE(json["plugins"].size(), 4u);
    const nlohmann::json &loaded = json["plugins"][0], &shadowed = json["plugins"][1], &refused = json["plugins"][2],
                         &importer = json["plugins"][3];
    EXPECT_EQ(loaded["path"], scratch_.path("p/a.so"));
    EXPECT_EQ(loaded["status"], "loaded");
    EXPECT_EQ(loaded["kind"], "accel");
    EXPECT_EQ(loaded["id"], "sound");
    EXPECT_EQ(loaded["name"], "A sound plugin");
    EXPECT_EQ(loaded["version"], "1.0");
    EXPECT_TRUE(loaded["reference"].is_null());
    EXPECT_EQ(loaded["capabilities"], nlohmann::json({"streams", "splits_incoherent"}));
    EXPECT_EQ(loaded["merit"], nlohmann::json({{"cpu", 0.25}, {"gpu", 0}}));
    EXPECT_EQ(loaded["ray_cost"], "linear");
    EXPECT_EQ(loaded["kernel_contract"], 1);
    EXPECT_EQ(loaded["packs_topologies"], false);
    EXPECT_EQ(loaded["abi_extensions"], nlohmann::json::array());
    ASSERT_EQ(loaded["parameters"].size(), 1u);
    const nlohmann::json expected = {{"key", "max_leaf"},
                                     {"label", "Max leaf size"},
                                     {"help", "primitives in a leaf, at most"},
                                     {"kind", "int"},
                                     {"effect", "rebuild"},
                                     {"min", 1},
                                     {"max", 16},
                                     {"default", 4}};
    EXPECT_EQ(loaded["parameters"][0], expected);
    EXPECT_EQ(shadowed["status"], "shadowed");
    EXPECT_EQ(refused["status"], "refused");
    EXPECT_EQ(refused["path"], scratch_.path("p/c.so"));
    EXPECT_NE(refused["why"].get<std::string>().find("ABI version 3"), std::string::npos);
    EXPECT_FALSE(refused.contains("id"));
    EXPECT_EQ(importer["kind"], "importer");
    EXPECT_FALSE(importer.contains("merit"));
    EXPECT_EQ(importer["extensions"], nlohmann::json({"shape"}));
}

TEST_F(PluginsCommand, JsonSurvivesAPathThatIsNotUtf8) {
    fs::copy_file(fs::path(TEST_PLUGINS) / "sound.so", scratch_.path("p/\xff.so"));
    EXPECT_NO_THROW({ const auto json = nlohmann::json::parse(output(true)); });
}

TEST_F(PluginsCommand, TextHasTheContentOfJson) {
    const std::string text = output(false);
    for (const char* words :
         {"accel     sound  (A sound plugin, 1.0)", "max_leaf=4", "primitives in a leaf, at most", "1 to 16", "needs a rebuild",
          "capabilities: streams, splits_incoherent", "merit: 0.25 on a CPU, not measured on a GPU; a ray's cost is linear",
          "SHADOWED", "REFUSED", "ABI version 3, this host speaks 2", "files: .shape"})
        EXPECT_NE(text.find(words), std::string::npos) << words << "\nin:\n" << text;
    for (const char* file : {"p/a.so", "p/b.so", "p/c.so", "p/d.so"})
        EXPECT_NE(text.find(scratch_.path(file)), std::string::npos) << file;
}

}  // namespace
