// The command `clarity plugins`: its output about loaded, shadowed and refused libraries, as text and as JSON.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/log.hpp"
#include "cli/commands.hpp"
#include "plugin/registry.hpp"
#include "support/scratch.hpp"

namespace {

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
