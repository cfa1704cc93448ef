#include "tools/lab/lab.hpp"

#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/files/output_file.hpp"
#include "base/files/read_file.hpp"
#include "plugin/plugin_check.hpp"

namespace clarity::lab {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& file, const std::string& why) {
    throw Error(Exit::usage, file + ": " + why + "; docs/teach.md lists the keys of a lab");
}

ordered_json read_json(const std::string& file) {
    const std::string text = read_file(file, kMaxTextFileBytes, Exit::usage);
    try {
        return ordered_json::parse(text, nullptr, true, true);
    } catch (const nlohmann::json::exception& e) {
        refuse(file, std::string("is no JSON: ") + e.what());
    }
}

// The value of a key, or `otherwise`.
template <class T>
T value(const ordered_json& json, const char* key, T otherwise, const std::string& file) {
    if (!json.contains(key)) return otherwise;
    try {
        return json.at(key).get<T>();
    } catch (const nlohmann::json::exception&) {
        refuse(file, std::string("`") + key + "` is " + json.at(key).dump() + ", which is no value for this key");
    }
}
std::string needed(const ordered_json& json, const char* key, const std::string& file) {
    if (!json.is_object() || !json.contains(key)) refuse(file, std::string("`") + key + "` is missing");
    return value<std::string>(json, key, "", file);
}

std::vector<Case> read_cases(const ordered_json& list, bool hidden, const std::string& file) {
    if (!list.is_array()) refuse(file, "`cases` is no list");
    std::vector<Case> cases;
    for (const ordered_json& json : list) {
        Case one;
        one.name = needed(json, "name", file), one.scene = needed(json, "scene", file);
        one.triangles = value(json, "triangles", 4000u, file), one.rays = value(json, "rays", 1000u, file);
        one.seed = value(json, "seed", uint64_t(0), file);
        one.poses = value(json, "poses", 1u, file);
        one.reference = value(json, "reference", 0.0, file);
        one.truth = value(json, "truth", std::vector<double>{}, file);
        one.color = value(json, "color", one.color, file);
        const ordered_json keys = value(json, "keys", ordered_json::object(), file);
        for (const auto& [key, number] : keys.items()) {
            std::array<double, 3> numbers{};
            if (number.is_array())
                numbers = value(keys, key.c_str(), numbers, file);
            else
                numbers[0] = value(keys, key.c_str(), 0.0, file);
            one.keys.emplace_back(key, numbers);
        }
        one.hidden = hidden;
        if (one.triangles < 1 || one.triangles > 1'000'000 || one.rays < 1 || one.rays > 1'000'000)
            refuse(file, "case " + one.name + ": `triangles` and `rays` are from 1 to a million");
        if (one.poses < 1 || one.poses > 100 || one.rays % one.poses != 0)
            refuse(file, "case " + one.name + ": `poses` is from 1 to 100, and each has as many of the rays");
        cases.push_back(one);
    }
    return cases;
}

// What leads out of a function of OpenCL C, to rays, hits, nodes and the host's counts.
const std::vector<std::string> kKernelWords = {
    "#",      "\"",    "'",       "\\",       "%:",        "??",     "asm",       "__asm",        "__asm__",
    "printf", "rt_",   "RT_",     "hit",      "ctx",       "ray",    "global",    "__global",     "constant",
    "void",   "union", "typedef", "intptr_t", "uintptr_t", "size_t", "ptrdiff_t", "__attribute__"};

// A name without a folder.
bool is_plain_name(const std::string& name) {
    return !name.empty() && name.front() != '.' && name.find('/') == std::string::npos;
}

}  // namespace

bool Lab::File::is_kernel() const {
    const std::string kind = fs::path(name).extension().string();
    return kind == ".h" || kind == ".cl";
}
bool Lab::has_builder() const {
    return std::any_of(files.begin(), files.end(), [](const File& file) { return !file.is_kernel(); });
}
std::string Lab::handout() const {
    return fs::is_directory(folder + "/handout") ? folder + "/handout" : folder;
}
std::vector<std::string> Lab::given() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(handout()))
        if (entry.is_regular_file() && entry.path().filename() != "lab.json" && entry.path().filename() != "page.md")
            all.push_back(entry.path().string());
    for (const std::string& name : shared) {
        const std::string beside = folder + "/../shared/" + name;
        // Students, and copies of a lab, have them in the handout.
        if (fs::exists(beside))
            all.push_back(beside);
        else if (!fs::exists(handout() + "/" + name))
            refuse(folder + "/lab.json", "`shared`: " + name + " is neither in " + folder + "/../shared nor in the handout");
    }
    return all;
}
std::string Lab::reference() const {
    return fs::is_directory(folder + "/reference") ? folder + "/reference" : "";
}

Lab read_lab(const std::string& folder, bool with_hidden) {
    const std::string file = folder + "/lab.json";
    if (!fs::exists(file))
        throw Error(Exit::usage, folder + ": is no lab: it has no lab.json; labs are in " + installed_labs());
    const ordered_json json = read_json(file);
    Lab lab;
    lab.folder = fs::canonical(folder).string();
    lab.id = needed(json, "id", file);
    if (!is_plugin_id(lab.id)) refuse(file, "`id` is no id of a plugin");
    lab.title = value<std::string>(json, "title", lab.id, file);
    lab.layout = value<std::string>(json, "layout", "", file);
    const std::string kind = value<std::string>(json, "kind", "accel", file);
    if (kind != "accel" && kind != "surface") refuse(file, "`kind` is '" + kind + "'; expected accel or surface");
    lab.is_surface = kind == "surface";
    if (!json.contains("files")) refuse(file, "`files` is missing");
    for (const ordered_json& one : json["files"]) {
        lab.files.push_back({needed(one, "name", file), value(one, "bytes", uint64_t(64) << 10, file)});
        if (!is_plain_name(lab.files.back().name)) refuse(file, "`files`: '" + lab.files.back().name + "' is no plain name");
        // What a student's CMake did would be done by the grader.
        if (lab.files.back().name == "CMakeLists.txt") refuse(file, "`files`: CMakeLists.txt is the teacher's");
    }
    lab.shared = value(json, "shared", std::vector<std::string>{}, file);
    for (const std::string& name : lab.shared)
        if (!is_plain_name(name)) refuse(file, "`shared`: '" + name + "' is no plain name");
    lab.forbidden = json.value("forbidden", ordered_json()) == "kernels"
                        ? kKernelWords
                        : value(json, "forbidden", std::vector<std::string>{}, file);
    lab.checks = value(json, "checks", std::vector<std::string>{}, file);
    lab.lanes = value(json, "lanes", 1, file);
    const ordered_json points = value(json, "points", ordered_json::object(), file);
    lab.points_checks = value(points, "checks", 50.0, file), lab.points_answers = value(points, "answers", 0.0, file);
    // No times are taken of models of surfaces.
    lab.points_counts = value(points, "counts", lab.is_surface ? 50.0 : 35.0, file);
    lab.points_speed = value(points, "speed", lab.is_surface ? 0.0 : 15.0, file);
    if (lab.is_surface && lab.points_speed != 0)
        refuse(file, "`points.speed` of a lab of surfaces is " + std::to_string(lab.points_speed) +
                         ", but their times are not taken; give these points to `counts`");
    lab.full = value(json, "full", 1.1, file), lab.none = value(json, "none", 8.0, file);
    if (!(lab.full > 0 && lab.none > lab.full)) refuse(file, "`none` must be larger than `full`, and both larger than 0");
    lab.compile_s = value(json, "compile_s", 120.0, file), lab.build_s = value(json, "build_s", 2.0, file);
    lab.memory_bytes = value(json, "memory_mib", uint64_t(1024), file) << 20;
    const ordered_json shown = value(json, "visibility", ordered_json::object(), file);
    lab.visibility = value<std::string>(shown, "public", "visible", file);
    lab.hidden_visibility = value<std::string>(shown, "hidden", "visible", file);
    lab.cases = read_cases(value(json, "cases", ordered_json::array(), file), false, file);
    const std::string hidden = folder + "/hidden/cases.json";
    if (with_hidden && fs::exists(hidden)) {
        const std::vector<Case> more = read_cases(read_json(hidden), true, hidden);
        lab.cases.insert(lab.cases.end(), more.begin(), more.end());
    }
    return lab;
}

void write_handout(const Lab& lab, const std::string& folder, const std::vector<Case>& known) {
    std::error_code error;
    if (fs::exists(folder) && !fs::is_empty(folder, error))
        throw Error(Exit::usage, folder + ": is there already, and not empty; take another folder");
    fs::create_directories(folder);
    for (const std::string& file : lab.given()) fs::copy_file(file, folder + "/" + fs::path(file).filename().string());
    if (fs::exists(lab.folder + "/page.md")) fs::copy(lab.folder + "/page.md", folder + "/page.md");
    ordered_json json = read_json(lab.folder + "/lab.json");
    for (size_t i = 0; i < known.size() && i < json["cases"].size(); ++i) {
        json["cases"][i]["reference"] = known[i].reference;
        if (!known[i].truth.empty()) json["cases"][i]["truth"] = known[i].truth;
    }
    write_text_file(folder + "/lab.json", json.dump(2) + "\n");
}

std::string installed_labs() {
    return (program_file().parent_path().parent_path() / "share/clarity/labs").string();
}

void copy_lab(const std::string& from, const std::string& to) {
    if (!fs::exists(from + "/lab.json")) {
        std::string names;
        std::error_code error;
        for (const auto& entry : fs::directory_iterator(installed_labs(), error))
            if (fs::exists(entry.path() / "lab.json")) names += (names.empty() ? "" : ", ") + entry.path().filename().string();
        throw Error(Exit::usage, from + ": no such lab to begin with; there are " + (names.empty() ? "none" : names));
    }
    if (fs::exists(to)) throw Error(Exit::usage, to + ": is there already; take another name");
    fs::copy(from, to, fs::copy_options::recursive);
    // Beside the copy there may be no `shared`.
    for (const std::string& file : read_lab(from, false).given())
        if (const std::string copy = to + "/handout/" + fs::path(file).filename().string(); !fs::exists(copy))
            fs::copy_file(file, copy);
}

}  // namespace clarity::lab
