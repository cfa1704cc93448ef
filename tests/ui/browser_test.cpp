// Tests of what the file browser, the log, the graph and the preferences compute, without a window.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "base/error.hpp"
#include "ui/app/preferences.hpp"
#include "ui/browser/file_listing.hpp"
#include "ui/hud/keys_hud.hpp"
#include "ui/panel/preset_folder.hpp"
#include "ui/widgets/log_rows.hpp"
#include "ui/widgets/plots.hpp"
#include "ui/widgets/scene_rows.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

class Folder : public testing::Test {
 protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "clarity_browser_XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        path_ = name;
    }
    void TearDown() override {
        std::error_code error;
        fs::permissions(path_ / "closed", fs::perms::owner_all, error);
        fs::remove_all(path_, error);
    }
    void file(const std::string& name, const std::string& text = "x") const { std::ofstream(path_ / name) << text; }
    Listing list(std::vector<std::string> extensions = {}) const {
        return list_folder({path_.string(), std::move(extensions)});
    }
    static std::vector<std::string> names(const Listing& listing) {
        std::vector<std::string> all;
        for (const FileEntry& entry : listing.entries) all.push_back(entry.name);
        return all;
    }
    fs::path path_;
};

using Names = std::vector<std::string>;

TEST_F(Folder, ListsFoldersFirstWithoutHiddenOnesAndDeadLinks) {
    fs::create_directories(path_ / "zoo");
    fs::create_directories(path_ / ".git");
    file("b.obj", "12345");
    file("A.PLY");
    file("notes.txt");
    file(".hidden.obj");
    fs::create_symlink("nowhere", path_ / "dead.obj");
    const Listing all = list();
    EXPECT_EQ(all.failure, "");
    EXPECT_EQ(names(all), (Names{"zoo", "A.PLY", "b.obj", "notes.txt"}));
    EXPECT_TRUE(all.entries[0].folder);
    EXPECT_EQ(all.entries[2].bytes, 5u);
    EXPECT_GT(all.entries[2].modified_s, 1500000000);
    EXPECT_EQ(names(list({"obj", "ply"})), (Names{"zoo", "A.PLY", "b.obj"}));
    EXPECT_EQ(names(list_folder({path_.string(), {}, false})), (Names{"zoo"}));
}

TEST_F(Folder, AcceptsExtensionsOfTwoPartsButNoBareExtensions) {
    file("dragon.ply.gz");
    file("archive.gz");
    file("ply.gz");
    EXPECT_EQ(names(list({"ply.gz"})), (Names{"dragon.ply.gz"}));
}

TEST_F(Folder, SaysWhyAFolderCannotBeRead) {
    EXPECT_NE(list_folder({(path_ / "missing").string(), {}}).failure.find("No such file"), std::string::npos);
    file("plain");
    EXPECT_NE(list_folder({(path_ / "plain").string(), {}}).failure, "");
    if (geteuid() == 0) GTEST_SKIP() << "root may read every folder";
    fs::create_directories(path_ / "closed");
    fs::permissions(path_ / "closed", fs::perms::none);
    EXPECT_NE(list_folder({(path_ / "closed").string(), {}}).failure.find("ermission"), std::string::npos);
}

TEST_F(Folder, ListsManyFiles) {
    for (int i = 0; i < 3000; ++i) file("model" + std::to_string(i) + ".obj", "");
    EXPECT_EQ(list({"obj"}).entries.size(), 3000u);
}

TEST_F(Folder, CompletesTheCommonPrefix) {
    fs::create_directories(path_ / "models");
    file("mosaic.obj");
    file("teapot_high.obj");
    file("teapot_low.obj");
    const Listing listing = list();
    EXPECT_EQ(complete(listing, "te"), "teapot_");
    EXPECT_EQ(complete(listing, "teapot_h"), "teapot_high.obj");
    EXPECT_EQ(complete(listing, "mod"), "models/");
    EXPECT_EQ(complete(listing, "mo"), "mo");
    EXPECT_EQ(complete(listing, "TEAPOT_H"), "teapot_high.obj");
    EXPECT_EQ(complete(listing, "nothing"), "nothing");
    EXPECT_EQ(complete(listing, ""), "");
    EXPECT_EQ(complete(listing, "/some/where/te"), "/some/where/teapot_");
}

TEST_F(Folder, NeverCompletesHalfACharacter) {
    file("caf\u00e9.obj");
    file("caf\u00e8.obj");  // its first byte is the same
    EXPECT_EQ(complete(list(), "c"), "caf");
}

TEST_F(Folder, FindsWordsAnywhereAndBeginningsFirst) {
    for (const char* name : {"a_dragon.obj", "Dragon.ply", "teapot.obj"}) file(name);
    const Listing listing = list();
    const auto found = matching(listing, "dra");
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(listing.entries[found[0]].name, "Dragon.ply");
    EXPECT_EQ(matching(listing, "").size(), 3u);
    EXPECT_TRUE(matching(listing, "xyz").empty());
}

TEST(Typed, TextIsSplitIntoFolderAndWord) {
    const auto check = [](const char* text, const std::string& folder, const std::string& word) {
        const Typed typed = split_typed(text, "/data/models");
        EXPECT_EQ(typed.folder, folder) << text;
        EXPECT_EQ(typed.word, word) << text;
    };
    check("", "/data/models", "");
    check("dra", "/data/models", "dra");
    check("old/dra", "/data/models/old", "dra");
    check("../dra", "/data", "dra");
    check("/usr/share/", "/usr/share", "");
    check("/", "/", "");
    check("~/x", home_folder(), "x");
    check("~", home_folder(), "");
    EXPECT_EQ(parent_folder("/"), "/");
    EXPECT_EQ(parent_folder("/a/b/"), "/a");
}

TEST(FrameGraph, PercentilesAreByNearestRank) {
    EXPECT_EQ(percentile({}, 0.5), 0);
    EXPECT_EQ(percentile({7}, 0.99), 7);
    std::vector<float> hundred;
    for (int i = 100; i >= 1; --i) hundred.push_back(static_cast<float>(i));
    EXPECT_EQ(percentile(hundred, 0.5), 50);
    EXPECT_EQ(percentile(hundred, 0.95), 95);
    EXPECT_EQ(percentile(hundred, 0.99), 99);
    EXPECT_EQ(percentile(hundred, 1), 100);
    EXPECT_EQ(percentile(hundred, 0), 1);
}

TEST(FrameGraph, AxesEndAtRoundNumbers) {
    EXPECT_FLOAT_EQ(axis_end(0.7f), 1);
    EXPECT_FLOAT_EQ(axis_end(1), 1);
    EXPECT_FLOAT_EQ(axis_end(1.3f), 2);
    EXPECT_FLOAT_EQ(axis_end(33), 50);
    EXPECT_FLOAT_EQ(axis_end(501), 1000);
    EXPECT_FLOAT_EQ(axis_end(0.03f), 0.05f);
    EXPECT_FLOAT_EQ(axis_end(0), 1);
    EXPECT_FLOAT_EQ(axis_end(std::numeric_limits<float>::infinity()), 1);
}

TEST(LogRows, FindPlacesInSourceFiles) {
    const auto place = find_source_place("  cl/tracers/iterative/iterative.cl:120:7: error: expected ';'");
    ASSERT_TRUE(place);
    EXPECT_EQ(place->file, "cl/tracers/iterative/iterative.cl");
    EXPECT_EQ(place->line, 120);
    EXPECT_EQ(place->begin, 2u);
    for (const char* text : {"device 0:0 is busy", "at 12:30", "https://host:80/", "ratio 1.5:1", "a.cl: no number",
                             "x.cl:", ":12", "a.cl:99999999999999999999"})
        EXPECT_FALSE(find_source_place(text)) << text;
    EXPECT_TRUE(find_source_place("device 0:0: bvh2.cl:3"));
}

TEST(LogRows, SplitEntriesAndFilterThem) {
    const std::vector<LogLine> lines = {
        {LogLevel::debug, "small talk"},
        {LogLevel::info, "opened a.obj"},
        {LogLevel::error, "bvh2: does not compile\nbvh2.cl:3:1: error: no such type\n\n  float9 x;"}};
    const auto rows = log_rows(lines, {});
    ASSERT_EQ(rows.size(), 6u);
    EXPECT_TRUE(rows[0].first);
    EXPECT_FALSE(rows[2].first);
    EXPECT_EQ(rows[2].text, "bvh2.cl:3:1");
    EXPECT_TRUE(rows[2].place);
    EXPECT_EQ(rows[3].text, "error: no such type");
    EXPECT_TRUE(rows[3].inside);
    EXPECT_EQ(log_rows(lines, {LogLevel::debug, ""}).size(), 7u);
    EXPECT_EQ(log_rows(lines, {LogLevel::error, ""}).size(), 5u);
    EXPECT_EQ(log_rows(lines, {LogLevel::debug, "OPENED obj"}).size(), 1u);
    EXPECT_TRUE(log_rows(lines, {LogLevel::debug, "nowhere"}).empty());
}

Preferences sample_preferences() {
    Preferences p;
    p.width = 1000;
    p.panel_width = 512;
    p.compare_mode = CompareMode::difference;
    p.moving_fps = 24;
    p.show_rays = false;
    p.browser_folder = "/data";
    p.pictures_folder = "/pictures";
    p.recent_files = {"/a.obj", "/b \"c\".ply"};
    p.bookmarked = {"/a.obj", "/b.obj\n/c.obj"};
    Bookmark bookmark{"from above", {}};
    bookmark.camera.eye = {1, 2, 0.1f};
    bookmark.camera.fov_y_rad = 0.5f;
    bookmark.pose = {1.25, "walk"};
    p.bookmarks["/a.obj"] = {bookmark};
    p.bookmarks["/b.obj\n/c.obj"] = {bookmark, bookmark};
    return p;
}

TEST(PreferencesJson, IsReadBackUnchanged) {
    const Preferences p = sample_preferences(), q = preferences_from(nlohmann::json::parse(to_json(p).dump()));
    EXPECT_EQ(to_json(q), to_json(p));
    EXPECT_EQ(q.panel_width, 512);
    EXPECT_EQ(q.compare_mode, CompareMode::difference);
    EXPECT_EQ(q.recent_files, p.recent_files);
    ASSERT_EQ(q.bookmarks.at("/b.obj\n/c.obj").size(), 2u);
    EXPECT_EQ(q.bookmarks.at("/a.obj")[0].name, "from above");
    EXPECT_EQ(q.bookmarks.at("/a.obj")[0].camera.eye, p.bookmarks.at("/a.obj")[0].camera.eye);
    EXPECT_EQ(q.bookmarks.at("/a.obj")[0].pose.time_s, 1.25);
    EXPECT_EQ(q.bookmarks.at("/a.obj")[0].pose.clip, "walk");
}

TEST(PreferencesJson, ValuesAreClampedOrRefused) {
    nlohmann::json json = to_json(sample_preferences());
    json["panel_width"] = -5;
    json["moving_fps"] = 1e9;
    json["compare_mode"] = "sideways";
    json["recent_files"] = std::vector<std::string>(500, "/x");
    json["bookmarks"][0]["views"][0]["camera"]["target"] = json["bookmarks"][0]["views"][0]["camera"]["eye"];
    const Preferences p = preferences_from(json);
    EXPECT_GE(p.panel_width, 200);
    EXPECT_LE(p.moving_fps, 240);
    EXPECT_EQ(p.compare_mode, CompareMode::wipe);
    EXPECT_EQ(p.recent_files.size(), kRecentFiles);
    EXPECT_TRUE(p.bookmarks.at("/a.obj").empty());  // dropped: a camera cannot look at its own position
    EXPECT_EQ(to_json(preferences_from(nlohmann::json::object())), to_json(Preferences{}));
    json["recent_files"] = "not a list";
    EXPECT_THROW(preferences_from(json), nlohmann::json::exception);
}

TEST_F(Folder, KeepsPresetsByName) {
    const std::string folder = (path_ / "presets").string();
    EXPECT_TRUE(preset_names(folder).empty());
    EXPECT_TRUE(preset_names("").empty());
    const std::string path = preset_path(folder, "soft light");
    EXPECT_EQ(path, folder + "/soft light.json");
    std::ofstream(path) << "{}";
    std::ofstream(folder + "/other.txt") << "";
    EXPECT_EQ(preset_names(folder), (Names{"soft light"}));
    EXPECT_EQ(preset_path(folder, "/elsewhere/p.json"), "/elsewhere/p.json");
    for (const char* name : {"", "a/b", "../up", ".hidden"}) EXPECT_THROW(preset_path(folder, name), Error) << name;
    EXPECT_THROW(preset_path("", "name"), Error);
}

std::shared_ptr<Scene> scene_of(size_t instances) {
    auto scene = std::make_shared<Scene>();
    scene->meshes.resize(2);
    scene->meshes[0].name = "leaf";
    scene->meshes[1].name = "trunk";
    scene->meshes[0].triangle_count = 2;
    scene->meshes[1].triangle_count = 5;
    scene->triangle_materials = {0, 0, 0, 0, 0};
    for (size_t i = 0; i < instances; ++i) {
        Instance instance;
        instance.mesh = i % 10 == 0 ? 1 : 0;
        instance.name = i == 7 ? "Odd One" : "";
        scene->instances.push_back(instance);
    }
    scene->materials.resize(1);
    scene->spheres.resize(3);
    return scene;
}

TEST(SceneRows, ListOpenAndFoundScenes) {
    const auto scene = scene_of(20);
    SceneRows rows;
    std::array<bool, kRowKinds> open{};
    EXPECT_EQ(rows.update(scene, "", open).size(), 4u);  // titles of instances, spheres, meshes, materials
    open[0] = true;
    EXPECT_EQ(rows.update(scene, "", open).size(), 24u);
    const auto found = rows.update(scene, "one odd", open);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].count, 1u);
    EXPECT_EQ(found[1].index, 7);
    EXPECT_EQ(row_name(*scene, RowKind::instance, 0), "trunk");
    EXPECT_EQ(row_name(*scene, RowKind::sphere, 2), "sphere 2");
    EXPECT_TRUE(rows.update(scene, "nothing has this name", open).empty());
    EXPECT_EQ(PrimNumbers(*scene).first(PrimPlace::Kind::sphere), 18u * 2 + 2 * 5);
    EXPECT_TRUE(rows.update(nullptr, "", open).empty());
}

// A row of the tree selects what a click into the picture selects.
TEST(SceneRows, SpheresPolygonsPlanesAndShapesAreThePrimitivesThatRaysHit) {
    const auto scene = scene_of(20);
    scene->polygons.resize(2);
    scene->planes.resize(1);
    scene->shape_kinds = {{"box", nullptr}, {"torus", nullptr}};
    for (const rt_u32 kind : {1u, 0u, 1u}) {
        Shape shape;
        shape.kind = kind;
        shape.material = 10 + kind;
        scene->shapes.push_back(shape);
    }
    EXPECT_EQ(row_count(*scene, RowKind::shape), 3u);
    EXPECT_EQ(row_name(*scene, RowKind::shape, 1), "box 1");
    EXPECT_EQ(row_name(*scene, RowKind::shape, 2), "torus 2");
    EXPECT_EQ(row_material(*scene, RowKind::shape, 2), 11u);
    const PrimNumbers numbers(*scene);
    const std::pair<RowKind, PrimPlace::Kind> kinds[] = {{RowKind::sphere, PrimPlace::Kind::sphere},
                                                         {RowKind::polygon, PrimPlace::Kind::polygon},
                                                         {RowKind::plane, PrimPlace::Kind::plane},
                                                         {RowKind::shape, PrimPlace::Kind::shape}};
    for (const auto& [row, place] : kinds)
        for (size_t i = 0; i < row_count(*scene, row); ++i) {
            const PrimPlace found = place_of_prim(*scene, row_prim(numbers, row, i));
            EXPECT_EQ(found.kind, place) << kind_title(row) << ' ' << i;
            EXPECT_EQ(found.index, i) << kind_title(row);
        }
    EXPECT_EQ(row_prim(numbers, RowKind::light, 0), -1);
    SceneRows rows;
    std::array<bool, kRowKinds> open{};
    open[static_cast<size_t>(RowKind::shape)] = true;
    const auto all = rows.update(scene, "", open);
    EXPECT_EQ(std::count_if(all.begin(), all.end(), [](const SceneRow& r) { return r.kind == RowKind::shape && r.index >= 0; }),
              3);
}

TEST(KeyList, TheListShowsEveryBinding) {
    const auto lines = key_lines();
    for (const KeyMap& map : key_maps())
        for (const KeyBinding& binding : map.bindings)
            EXPECT_EQ(std::count_if(lines.begin(), lines.end(), [&](const KeyLine& line) { return line.help == binding.help; }),
                      1)
                << binding.name;
    for (const KeyLine& line : lines) EXPECT_EQ(line.keys.size(), key_maps().size());
}

}  // namespace
}  // namespace clarity::ui
