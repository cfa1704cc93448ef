#include "tools/check/importers/samples.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/read_file.hpp"
#include "base/text.hpp"
#include "stand/seed.hpp"

namespace fs = std::filesystem;

namespace clarity::check {
namespace {

constexpr uint64_t kMostTruthBytes = uint64_t(64) << 20;
constexpr uint64_t kMostSeedBytes = uint64_t(1) << 20;  // of a sample that is damaged: larger ones would only take longer
constexpr size_t kMostSeeds = 6;

bool has_extension(const rt_importer& importer, const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = lower(c);
    for (const char* const* e = importer.extensions; e && *e; ++e)
        if (extension == std::string(".") + *e) return true;
    return false;
}

// Reads the keys of a truth.
class TruthReader {
 public:
    TruthReader(const std::string& path, const nlohmann::json& json) : path_(path), json_(json) {}

    Contents read() {
        const std::pair<const char*, std::optional<double>*> numbers[] = {
            {"triangles", &held_.triangles},      {"area", &held_.area}, {"instance_count", &held_.instances},
            {"material_count", &held_.materials}, {"flat", &held_.flat}, {"volume", &held_.volume}};
        for (const auto& [key, to] : numbers)
            if (const nlohmann::json* value = find(json_, key)) *to = number(*value, key);
        // Where faces with many corners are cut in another way, the area of a fan may be all that is known.
        if (const nlohmann::json* fan = held_.area ? nullptr : find(json_, "area_fan")) held_.area = number(*fan, "area_fan");
        // A file without triangles has no box.
        if (const nlohmann::json* box = held_.triangles == 0.0 ? nullptr : find(json_, "bbox")) held_.bounds = box_of(*box);
        if (const nlohmann::json* corners = find(json_, "corners")) {
            if (!corners->is_array()) wrong("corners", "a list of objects {\"at\": [x, y, z], ...}");
            for (const nlohmann::json& corner : *corners) held_.corners.push_back(corner_of(corner));
        }
        if (const nlohmann::json* counts = find(json_, "material_triangles")) {
            if (!counts->is_object()) wrong("material_triangles", "an object {\"NAME\": triangles, ...}");
            for (const auto& [name, count] : counts->items()) held_.material_triangles[name] = number(count, name);
        }
        if (const nlohmann::json* list = find(json_, "instances")) {
            if (!list->is_array()) wrong("instances", "a list of objects {\"name\": NAME, ...}");
            for (const nlohmann::json& one : *list) held_.placed.push_back(placed_of(one));
        }
        if (held_.keys.empty())
            throw Error(Exit::usage,
                        path_ +
                            ": states nothing about the file; it needs one of the keys triangles, area, bbox, instance_count, "
                            "material_count, flat, volume, corners, material_triangles and instances, such as {\"triangles\": "
                            "12, \"bbox\": [[0, 0, 0], [1, 1, 1]]}");
        return std::move(held_);
    }

 private:
    [[noreturn]] void wrong(const std::string& key, const std::string& expected) const {
        throw Error(Exit::usage, path_ + ": the key '" + key + "' must be " + expected);
    }
    // What is null is not known.
    const nlohmann::json* find(const nlohmann::json& in, const char* key) {
        const auto at = in.find(key);
        if (at == in.end() || at->is_null()) return nullptr;
        if (&in == &json_) held_.keys += (held_.keys.empty() ? "" : ", ") + std::string(key);
        return &*at;
    }
    double number(const nlohmann::json& value, const std::string& key) const {
        if (!value.is_number()) wrong(key, "a number");
        return value;
    }
    Vec vector(const nlohmann::json& value, const std::string& key) const {
        if (!value.is_array() || value.size() != 3) wrong(key, "of three numbers, [x, y, z]");
        return {number(value.at(0), key), number(value.at(1), key), number(value.at(2), key)};
    }
    std::array<Vec, 2> box_of(const nlohmann::json& box) const {
        if (!box.is_array() || box.size() != 2) wrong("bbox", "the least and the greatest corner");
        return {vector(box.at(0), "bbox"), vector(box.at(1), "bbox")};
    }
    // An object of a list, which has the first of these keys and no other ones.
    void expect_keys(const nlohmann::json& json, const char* list, const std::vector<std::string>& keys) const {
        std::string names;
        for (const std::string& key : keys) names += (names.empty() ? "" : ", ") + key;
        if (!json.is_object() || !json.contains(keys.front())) wrong(list, "of objects with the key " + keys.front());
        for (const auto& [key, value] : json.items())
            if (std::find(keys.begin(), keys.end(), key) == keys.end())
                wrong(list, "of objects with the keys " + names + ", not '" + key + "'");
    }
    Contents::Placed placed_of(const nlohmann::json& json) {
        expect_keys(json, "instances", {"name", "triangles", "bbox"});
        if (!json["name"].is_string()) wrong("name", "a text");
        Contents::Placed placed{json["name"], {}, {}};
        if (const auto* triangles = find(json, "triangles")) placed.triangles = number(*triangles, "triangles");
        if (const auto* box = find(json, "bbox")) placed.bounds = box_of(*box);
        return placed;
    }
    Contents::Corner corner_of(const nlohmann::json& json) {
        expect_keys(json, "corners", {"at", "normal", "facing", "uv"});
        Contents::Corner corner;
        corner.at = vector(json["at"], "at");
        if (const auto* normal = find(json, "normal")) corner.normal = vector(*normal, "normal");
        if (const auto* facing = find(json, "facing")) corner.facing = vector(*facing, "facing");
        if (const auto* uv = find(json, "uv")) {
            if (!uv->is_array() || uv->size() != 2) wrong("uv", "of two numbers, [u, v]");
            corner.uv = {number(uv->at(0), "uv"), number(uv->at(1), "uv")};
        }
        return corner;
    }

    const std::string& path_;
    const nlohmann::json& json_;
    Contents held_;
};

// Nothing where the other program could not read the file either.
std::optional<Contents> read_truth(const std::string& path, const nlohmann::json& json) {
    if (!json.is_object()) throw Error(Exit::usage, path + ": is no truth of a file: it must hold a JSON object");
    const nlohmann::json& whole = json.contains("truth") && json["truth"].is_object() ? json["truth"] : json;
    const nlohmann::json& held = whole.contains("static") && whole["static"].is_object() ? whole["static"] : whole;
    if (whole.contains("ok") && whole["ok"] == false) return std::nullopt;
    Contents truth = TruthReader(path, held).read();
    truth.undeformed = whole.contains("static");
    return truth;
}

using Random = std::mt19937;

size_t below(Random& random, size_t end) {
    return end == 0 ? 0 : random() % end;
}

std::string hex(unsigned char byte) {
    char text[8];
    std::snprintf(text, sizeof text, "0x%02X", byte);
    return text;
}

bool in_number(char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
}

Mutant cut(const std::string& bytes, Random& random) {
    const size_t length = below(random, bytes.size());
    return {"only the first " + std::to_string(length) + " bytes", bytes.substr(0, length)};
}

Mutant change_byte(const std::string& bytes, Random& random) {
    Mutant mutant{{}, bytes};
    const size_t at = below(random, bytes.size());
    constexpr unsigned char kBytes[] = {0x00, 0xFF, 0x7F, 0x80, '{', '}', '"', '\n', '9', '/'};
    const auto before = static_cast<unsigned char>(bytes[at]);
    const unsigned char after =
        random() % 2 ? kBytes[below(random, std::size(kBytes))] : static_cast<unsigned char>(before ^ (1u << random() % 8));
    mutant.bytes[at] = static_cast<char>(after);
    mutant.what = "byte " + std::to_string(at) + " is " + hex(after) + " instead of " + hex(before);
    return mutant;
}

// Counts and offsets of binary files are words.
Mutant change_word(const std::string& bytes, Random& random) {
    Mutant mutant{{}, bytes};
    const size_t at = below(random, bytes.size() / 4) * 4;
    constexpr const char* kWords[] = {"\xFF\xFF\xFF\xFF", "\xFF\xFF\xFF\x7F", "\x00\x00\x00\x80", "\x00\x00\x00\x10",
                                      "\x00\x00\xC0\x7F"};
    constexpr const char* kNames[] = {"0xFFFFFFFF", "0x7FFFFFFF", "0x80000000", "0x10000000", "NaN"};
    const size_t which = below(random, std::size(kWords));
    for (size_t i = 0; i < 4 && at + i < bytes.size(); ++i) mutant.bytes[at + i] = kWords[which][i];
    mutant.what = "the word at byte " + std::to_string(at) + " is " + kNames[which];
    return mutant;
}

Mutant change_block(const std::string& bytes, Random& random) {
    Mutant mutant{{}, bytes};
    const size_t at = below(random, bytes.size()), size = 1 + below(random, std::min<size_t>(bytes.size() - at, 300));
    const std::string place = std::to_string(size) + " bytes from byte " + std::to_string(at) + " are ";
    switch (random() % 3) {
        case 0:
            mutant.bytes.erase(at, size);
            mutant.what = place + "left out";
            break;
        case 1: {
            std::string many;
            for (int i = 0; i < 50; ++i) many += bytes.substr(at, size);
            mutant.bytes.insert(at, many);
            mutant.what = place + "there 51 times";
            break;
        }
        default:
            std::fill_n(mutant.bytes.begin() + static_cast<std::ptrdiff_t>(at), size, '\0');
            mutant.what = place + "zero";
    }
    return mutant;
}

constexpr const char* kNumbers[] = {"4294967295",           "-1", "1e999",      "nan",   "inf",
                                    "99999999999999999999", "0",  "2147483648", "1e-60", ""};

// Replaces the number of a text that stands at or after a place. `place` becomes the end of the new one, or that of the file if
// there is none.
Mutant change_number(const std::string& bytes, size_t& place, const char* number) {
    size_t begin = place;
    while (begin < bytes.size() && !(bytes[begin] >= '0' && bytes[begin] <= '9')) ++begin;
    while (begin > place && in_number(bytes[begin - 1])) --begin;
    size_t end = begin;
    while (end < bytes.size() && in_number(bytes[end])) ++end;
    place = end;
    Mutant mutant{{}, bytes};
    mutant.bytes.replace(begin, end - begin, number);
    mutant.what = "'" + bytes.substr(begin, std::min<size_t>(end - begin, 40)) + "' at byte " + std::to_string(begin) +
                  " is '" + number + "'";
    return mutant;
}

Mutant change_any_number(const std::string& bytes, Random& random) {
    size_t place = below(random, bytes.size());
    Mutant mutant = change_number(bytes, place, kNumbers[below(random, std::size(kNumbers))]);
    return mutant.bytes == bytes ? change_byte(bytes, random) : mutant;
}

}  // namespace

std::vector<std::string> samples_among(const rt_importer& importer, const std::vector<std::string>& files_and_folders) {
    std::vector<std::pair<uint64_t, std::string>> found;
    const auto add = [&](const fs::path& path) { found.emplace_back(fs::file_size(path), fs::canonical(path).string()); };
    for (const std::string& name : files_and_folders) {
        if (!fs::exists(name)) throw Error(Exit::usage, "--samples " + name + ": there is no such file or folder");
        if (!fs::is_directory(name)) {
            add(name);
            continue;
        }
        for (const auto& entry : fs::recursive_directory_iterator(name))
            if (entry.is_regular_file() && has_extension(importer, entry.path())) add(entry.path());
    }
    std::sort(found.begin(), found.end());
    std::vector<std::string> samples;
    for (auto& [bytes, path] : found)
        if (samples.empty() || samples.back() != path) samples.push_back(std::move(path));
    return samples;
}

std::optional<Contents> truth_of(const std::string& file, const std::string& folder) {
    if (fs::exists(file + ".json"))
        return read_truth(file + ".json",
                          nlohmann::json::parse(read_file(file + ".json", kMostTruthBytes, Exit::usage), nullptr, false));
    if (folder.empty()) return std::nullopt;
    const fs::path path(file);
    const std::string end = path.parent_path().filename().string() + "/" + path.filename().string();
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        // The name alone keeps most files unread.
        if (entry.path().extension() != ".json" || name.find(path.filename().string()) == std::string::npos) continue;
        const auto json = nlohmann::json::parse(read_file(entry.path().string(), kMostTruthBytes, Exit::usage), nullptr, false);
        if (json.is_object() && json.value("file", "") == end) return read_truth(entry.path().string(), json);
    }
    return std::nullopt;
}

std::vector<HostileFile> write_hostile_files(const rt_importer& importer, const std::vector<std::string>& samples,
                                             const std::string& folder, unsigned count, uint64_t seed) {
    std::vector<HostileFile> files;
    const auto write = [&](const Mutant& mutant, const std::string& extension, const std::string& of) {
        const std::string path = folder + "/hostile_" + std::to_string(files.size()) + extension;
        write_text_file(path, mutant.bytes);
        files.push_back({path, of + mutant.what});
    };
    for (const Mutant& mutant : junk()) write(mutant, std::string(".") + importer.extensions[0], "");
    std::vector<std::string> seeds;
    for (const std::string& sample : samples)
        if (seeds.size() < kMostSeeds && fs::file_size(sample) > 0 && fs::file_size(sample) <= kMostSeedBytes)
            seeds.push_back(sample);
    for (const std::string& sample : seeds) {
        const fs::path path(sample);
        const std::string bytes = read_file(sample, kMostSeedBytes, Exit::failed);
        for (const Mutant& mutant : mutants_of(bytes, count / static_cast<unsigned>(seeds.size()), seed))
            write(mutant, path.extension().string(), path.filename().string() + ", but ");
    }
    return files;
}

std::vector<Mutant> mutants_of(const std::string& bytes, unsigned count, uint64_t seed) {
    std::vector<Mutant> mutants;
    if (bytes.empty()) return mutants;
    Random random = random_of(static_cast<unsigned>(bytes.size()), seed);
    constexpr Mutant (*kWays[])(const std::string&, Random&) = {cut, change_byte, change_word, change_block, change_any_number};
    // Counts stand at the head of a file: its first numbers get every impossible value.
    for (const char* number : kNumbers)
        for (size_t n = 0, place = 0; n < 3 && place < std::min<size_t>(bytes.size(), 4096); ++n)
            mutants.push_back(change_number(bytes, place, number));
    for (unsigned i = 0; i < count; ++i) mutants.push_back(kWays[i % std::size(kWays)](bytes, random));
    return mutants;
}

std::vector<Mutant> junk() {
    constexpr size_t kMany = 1u << 18;
    Random random(1);
    std::string noise(kMany, '\0');
    for (char& c : noise) c = static_cast<char>(random());
    return {{"one space", " "},
            {"one byte 0xFF", "\xFF"},
            {"zeros", std::string(kMany, '\0')},
            {"random bytes", noise},
            {"brackets that are never closed", std::string(kMany, '{') + std::string(kMany, '(') + std::string(kMany, '[')},
            {"one line of digits without end", std::string(kMany, '7')},
            {"empty lines only", std::string(kMany, '\n')},
            {"quotation marks only", std::string(kMany, '"')}};
}

}  // namespace clarity::check
