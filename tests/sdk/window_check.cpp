// window_check.cpp -- part of the test sdk_out_of_tree: the window of the installed program takes a plugin that is built again,
// and its kernel, while it is open. CLARITY_WORKER: that program. CLARITY_TEST_PLUGIN: the plugin's folder, made by `clarity
// new-plugin accel boxes`, with its build folder.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

class OutOfTree : public WindowTest {
 protected:
    std::string read(const std::string& name) const {
        std::ifstream in(folder_ + "/" + name);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ + "/" + name) << text; }
    // Changes a file of the plugin. The test fails if the text to replace is not there.
    void edit(const std::string& name, const std::string& from, const std::string& to) const {
        std::string text = read(name);
        const size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << name << " of the template has changed: edit something else of it here";
        write(name, text.replace(at, from.size(), to));
    }
    int build() const { return std::system(("cmake --build '" + folder_ + "/build' >/dev/null 2>&1").c_str()); }
    const std::string folder_ = std::getenv("CLARITY_TEST_PLUGIN");
};

TEST_F(OutOfTree, ARebuiltPluginAndASavedKernelAreInForceInTheOpenWindow) {
    WindowDriver window({"--size", "64x48", "--accel", "boxes", folder_ + "/try.scene"});
    window.settle();
    ASSERT_EQ(window.state()["message"], "");
    const Pixels before = window.picture();

    // A builder that leaves out the last primitive, and one parameter more.
    int revision = window.state()["kernel_revision"];
    const std::string sound = read("boxes.cpp");
    edit("boxes.cpp", "++b.count;", "if (leaf + 1 < prim_count) ++b.count;");
    edit("boxes.cpp", "constexpr rt_param kParams[] = {",
         "constexpr rt_param kParams[] = {rt::int_param(\"more\", \"More\", \"nothing\", 1, 9, 5), ");
    edit("boxes.cpp", "enum Param { kBlockSize };", "enum Param { kMore, kBlockSize };");
    ASSERT_EQ(build(), 0);
    const auto built = std::chrono::steady_clock::now();
    ASSERT_TRUE(window.reaches([&](const nlohmann::json& state) { return state["kernel_revision"] > revision; }));
    EXPECT_LT(seconds_since(built), at_most(2)) << "from the linker's end to the new library";
    window.settle();
    EXPECT_EQ(window.state()["message"], "");
    const Pixels without = window.picture();
    EXPECT_GT(difference(before, without), 0.01);
    EXPECT_EQ(window.command("accel boxes,more=7,block=4"), "") << "the new parameter";

    // A library that cannot be taken is one message, and the old one goes on.
    std::remove((folder_ + "/build/boxes.so").c_str());  // as linkers do: the file may still be mapped
    write("build/boxes.so", "no library");
    ASSERT_TRUE(window.reaches([](const nlohmann::json& state) { return state["messages"] == 1; }));
    const std::string message = window.state()["message"];
    EXPECT_NE(message.find("boxes.so: was built again and is refused"), std::string::npos) << message;
    window.settle();
    EXPECT_EQ(difference(without, window.picture()), 0);

    // The sound one again.
    revision = window.state()["kernel_revision"];
    write("boxes.cpp", sound);
    ASSERT_EQ(build(), 0);
    ASSERT_TRUE(window.reaches([&](const nlohmann::json& state) { return state["kernel_revision"] > revision; }));
    window.settle();
    EXPECT_EQ(window.state()["message"], "");
    EXPECT_EQ(difference(before, window.picture()), 0);

    // The kernel, from the folder of the sources.
    revision = window.state()["kernel_revision"];
    edit("boxes.cl", "for (uint i = 0;", "for (uint i = 1;");
    ASSERT_TRUE(window.reaches([&](const nlohmann::json& state) { return state["kernel_revision"] > revision; }));
    window.settle();
    EXPECT_EQ(window.state()["message"], "") << window.errors();
    EXPECT_GT(difference(before, window.picture()), 0.01);
    window.quit();
    EXPECT_EQ(window.exit_code(), 0);
}

}  // namespace
}  // namespace clarity::ui
