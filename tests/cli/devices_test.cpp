// devices_test.cpp -- machines with broken OpenCL: no driver, a platform without devices, a platform which fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

constexpr const char* kSystemDrivers = "/etc/OpenCL/vendors";

// A folder of drivers as OCL_ICD_VENDORS expects it.
class Devices : public ::testing::Test {
 protected:
    void SetUp() override { std::filesystem::create_directory(scratch_.path("vendors")); }
    void add_fake(const std::string& name) {
        scratch_.write("vendors/" + name + ".icd", std::string(FAKE_DRIVERS) + "/" + name + ".so\n");
    }
    bool add_system_drivers() {
        bool any = false;
        std::error_code error;
        for (const auto& entry : std::filesystem::directory_iterator(kSystemDrivers, error)) {
            std::filesystem::copy_file(entry.path(), scratch_.path("vendors/" + entry.path().filename().string()));
            any = true;
        }
        return any && run_program({"devices"}).exit_code == 0;
    }
    ProgramResult run(std::vector<std::string> words, const std::string& device = "") {
        RunOptions options;
        options.environment = {{"OCL_ICD_VENDORS", scratch_.path("vendors")}, {"CLARITY_DEVICE", device}};
        return run_program(words, options);
    }
    // A rendered picture: how the program ended, the JSON of --stats, and the file's bytes.
    struct Rendered {
        ProgramResult result;
        nlohmann::json stats;
        std::string picture;
    };
    Rendered render(const std::string& devices) {
        const std::string png = scratch_.path("picture.png"), json = scratch_.path("stats.json");
        std::filesystem::remove(png);
        std::filesystem::remove(json);
        Rendered rendered{run({"render", std::string(CLARITY_SOURCE_DIR) + "/scenes/primitives.scene", "-o", png, "--size",
                               "160x120", "--spp", "3", "--device", devices, "--stats", json}),
                          {},
                          {}};
        if (std::filesystem::exists(json)) rendered.stats = nlohmann::json::parse(read(json));
        if (std::filesystem::exists(png)) rendered.picture = read(png);
        return rendered;
    }
    static std::string read(const std::string& path) {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    std::string scene() { return scratch_.write("a.scene", "sphere center 0 0 0 radius 1\n"); }

    Scratch scratch_;
};

}  // namespace

TEST_F(Devices, NoDriverExits3AndNamesThePackage) {
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"devices"}, {"devices", "--json"}, {"render", scene(), "-o", scratch_.path("a.png")}}) {
        const ProgramResult result = run(words);
        EXPECT_EQ(result.exit_code, 3) << result.err;
        EXPECT_NE(result.err.find("pocl-opencl-icd"), std::string::npos) << result.err;
    }
    EXPECT_FALSE(std::filesystem::exists(scratch_.path("a.png")));
    // stdout is data: an empty list.
    EXPECT_EQ(nlohmann::json::parse(run({"devices", "--json"}).out)["devices"], nlohmann::json::array());
    EXPECT_EQ(run({"devices"}).out, "");
}

TEST_F(Devices, PlatformsWithoutDevicesAreNamedWithTheirReason) {
    add_fake("empty");
    ProgramResult result = run({"devices"});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_NE(result.err.find("Fake platform) is skipped: it has no device"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("pocl-opencl-icd"), std::string::npos) << result.err;
    add_fake("failing");
    result = run({"devices", "--json"});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_EQ(nlohmann::json::parse(result.out)["warnings"].size(), 2u) << result.out;
    EXPECT_NE(result.out.find("it ran out of resources"), std::string::npos) << result.out;
}

TEST_F(Devices, BrokenPlatformsDoNotHideWorkingOnes) {
    if (!add_system_drivers()) GTEST_SKIP() << "no OpenCL device on this machine";
    add_fake("empty");
    add_fake("failing");
    const ProgramResult result = run({"devices", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const nlohmann::json list = nlohmann::json::parse(result.out);
    ASSERT_GE(list["devices"].size(), 1u);
    const auto of_fakes = [](const nlohmann::json& warning) {
        return warning.get<std::string>().find("Fake platform") != std::string::npos;
    };
    EXPECT_EQ(std::count_if(list["warnings"].begin(), list["warnings"].end(), of_fakes), 2) << result.out;
    // A driver without devices is no news where another has some; one that fails is.
    const std::string told = run({"render", scene(), "-o", scratch_.path("a.png"), "--size", "16x12"}).err;
    EXPECT_EQ(told.find("it has no device"), std::string::npos) << told;
    EXPECT_NE(told.find("it ran out of resources"), std::string::npos) << told;
    const nlohmann::json first = list["devices"][0];
    EXPECT_EQ(list["default"], first["id"]) << "the first device is the best one and the default";
    EXPECT_TRUE(first["default"].get<bool>());
    EXPECT_GT(first["compute_units"].get<int>(), 0);
    EXPECT_GT(first["global_bytes"].get<uint64_t>(), 0u);
    EXPECT_NE(run({"devices"}).out.find("default: "), std::string::npos);
}

TEST_F(Devices, CanBeChosenByNumberKindAndName) {
    if (!add_system_drivers()) GTEST_SKIP() << "no OpenCL device on this machine";
    const nlohmann::json list = nlohmann::json::parse(run({"devices", "--json"}).out);
    for (const auto& device : list["devices"]) {
        const std::string id = device["id"];
        const nlohmann::json chosen = nlohmann::json::parse(run({"devices", "--json"}, id).out);
        EXPECT_EQ(chosen["default"], id);
        EXPECT_EQ(chosen["why"], "CLARITY_DEVICE=" + id);
        const std::string kind = device["type"], name = device["name"];
        EXPECT_FALSE(nlohmann::json::parse(run({"devices", "--json"}, kind).out)["default"].is_null()) << kind;
        EXPECT_FALSE(nlohmann::json::parse(run({"devices", "--json"}, name.substr(1, 6)).out)["default"].is_null()) << name;
    }
    for (const char* nobody : {"9:9", "0:", "7", "no such device", "cpu,gpu"}) {
        const ProgramResult result = run({"render", scene(), "-o", scratch_.path("a.png"), "--device", nobody});
        EXPECT_EQ(result.exit_code, 3) << nobody << "\n" << result.err;
        EXPECT_NE(result.err.find(list["devices"][0]["id"].get<std::string>()), std::string::npos)
            << "the message must list the devices: " << result.err;
    }
}

TEST_F(Devices, SeveralRenderThePictureOfOne) {
    if (!add_system_drivers()) GTEST_SKIP() << "no OpenCL device on this machine";
    const Rendered alone = render("cpu"), shared = render("cpu/2");
    if (shared.result.exit_code == 3) GTEST_SKIP() << "NOT TESTED: " << shared.result.err;
    ASSERT_EQ(shared.result.exit_code, 0) << shared.result.err;
    ASSERT_FALSE(alone.picture.empty());
    EXPECT_TRUE(alone.picture == shared.picture);
    EXPECT_FALSE(alone.stats.contains("devices"));
    ASSERT_EQ(shared.stats["devices"].size(), 2u);
    double whole = 0;
    std::string ids;
    for (const auto& device : shared.stats["devices"]) {
        whole += device["share"].get<double>();
        ids += (ids.empty() ? "" : ",") + device["id"].get<std::string>();
        EXPECT_GT(device["frame_ms"].get<double>(), 0);
        EXPECT_GE(device["launches"].get<int>(), 3);
    }
    EXPECT_NEAR(whole, 1, 0.01);
    EXPECT_EQ(shared.stats["device_id"], ids);
    EXPECT_EQ(shared.stats["rays"], alone.stats["rays"]);
    EXPECT_TRUE(render(ids).picture == alone.picture) << "ids of the list are accepted by --device: " << ids;
}

TEST_F(Devices, AMissingDeviceIsNamed) {
    if (!add_system_drivers()) GTEST_SKIP() << "no OpenCL device on this machine";
    for (const char* words : {"0,99", "0,no such device", "0,gpu/2"}) {
        const Rendered rendered = render(words);
        if (rendered.result.exit_code == 0) continue;  // this machine has a GPU which can be split
        EXPECT_EQ(rendered.result.exit_code, 3) << rendered.result.err;
        const std::string word = std::string(words).substr(2);
        EXPECT_NE(rendered.result.err.find(word.substr(0, word.find('/'))), std::string::npos) << rendered.result.err;
        EXPECT_TRUE(rendered.picture.empty());
    }
}

TEST_F(Devices, ADeviceThatCannotBeOpenedIsAWarning) {
    if (!add_system_drivers()) GTEST_SKIP() << "no OpenCL device on this machine";
    const Rendered alone = render("0");
    add_fake("broken");
    const Rendered rendered = render("all");
    EXPECT_EQ(rendered.result.exit_code, 0) << rendered.result.err;
    EXPECT_TRUE(rendered.picture == alone.picture || rendered.stats.contains("devices"));
    EXPECT_NE(rendered.result.err.find("Broken device) cannot be opened"), std::string::npos) << rendered.result.err;
    EXPECT_NE(rendered.result.err.find("go on without it"), std::string::npos) << rendered.result.err;
    // If it is the only device, that is an error.
    const Rendered failed = render("Broken");
    EXPECT_EQ(failed.result.exit_code, 3) << failed.result.err;
    EXPECT_NE(failed.result.err.find("Broken device) cannot be opened"), std::string::npos) << failed.result.err;
    EXPECT_NE(run({"devices"}).out.find("Broken device"), std::string::npos);
}

TEST_F(Devices, TheListExplainsHowToNameSeveral) {
    if (!add_system_drivers()) GTEST_SKIP() << "no OpenCL device on this machine";
    const std::string text = run({"devices"}).out;
    EXPECT_EQ(text.find("0 = "), 0u) << text;
    EXPECT_NE(text.find("--device 0,1"), std::string::npos) << text;
    const nlohmann::json all = nlohmann::json::parse(run({"devices", "--json"}, "all").out);
    for (size_t i = 0; i < all["devices"].size(); ++i) {
        EXPECT_EQ(all["devices"][i]["number"], i);
        EXPECT_TRUE(all["devices"][i]["default"].get<bool>());
    }
}
