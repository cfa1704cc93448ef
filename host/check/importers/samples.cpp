#include "check/importers/samples.hpp"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/read_file.hpp"
#include "base/lower.hpp"

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

// Nothing where the file holds no triangle: its box is null.
std::optional<Contents> read_truth(const std::string& path, const nlohmann::json& json) {
    try {
        const nlohmann::json& whole = json.contains("truth") ? json.at("truth") : json;
        const nlohmann::json& held = whole.contains("static") ? whole.at("static") : whole;
        if (held.at("triangles") == 0) return std::nullopt;
        Contents truth{};
        truth.triangles = held.at("triangles");
        truth.undeformed = whole.contains("static");
        truth.area = held.contains("area") ? held.at("area") : held.at("area_fan");
        for (int k = 0; k < 3; ++k) {
            truth.lo[k] = held.at("bbox").at(0).at(k);
            truth.hi[k] = held.at("bbox").at(1).at(k);
        }
        return truth;
    } catch (const nlohmann::json::exception& e) {
        throw Error(Exit::usage, path + ": is no truth of a file: " + e.what() +
                                     "; it needs {\"triangles\": n, \"area\": a, \"bbox\": [[x, y, z], [x, y, z]]}");
    }
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
        return read_truth(file + ".json", nlohmann::json::parse(read_file(file + ".json", kMostTruthBytes, Exit::usage)));
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
                                             const std::string& folder, unsigned count) {
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
    for (const std::string& seed : seeds) {
        const fs::path path(seed);
        const std::string bytes = read_file(seed, kMostSeedBytes, Exit::failed);
        for (const Mutant& mutant : mutants_of(bytes, count / static_cast<unsigned>(seeds.size())))
            write(mutant, path.extension().string(), path.filename().string() + ", but ");
    }
    return files;
}

}  // namespace clarity::check
