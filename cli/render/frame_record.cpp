#include "cli/render/frame_record.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/read_file.hpp"
#include "base/numbers.hpp"
#include "base/text.hpp"

namespace clarity {
namespace {

using RecordJson = nlohmann::ordered_json;

std::string absolute(const std::string& path) {
    std::error_code error;
    const std::filesystem::path full = std::filesystem::absolute(path, error);
    return error ? path : full.string();
}

RecordJson absolute_paths(const std::vector<std::string>& paths) {
    RecordJson json = RecordJson::array();
    for (const std::string& path : paths) json.push_back(absolute(path));
    return json;
}

RecordJson options_json(const RenderOptions& options) {
    RecordJson json;
    json["scene"] = absolute_paths(options.scene.files);
    json["search_path"] = absolute_paths(options.scene.import.search_paths);
    json["importer"] = options.scene.import.importers;
    json["device"] = options.trace.device;
    json["accel"] = options.trace.accel;
    json["set"] = options.trace.sets;
    json["settings"] = options.trace.settings;
    json["all_aovs"] = options.all_aovs;
    json["crop"] = options.crop;
    json["error"] = options.error;
    json["time_budget"] = options.time_budget_s;
    json["camera"] = options.trace.camera;
    json["light"] = options.trace.light;
    json["preset"] = options.trace.preset.empty() ? "" : absolute(options.trace.preset);
    json["frames"] = options.frames;
    json["time"] = options.pose.time_s ? RecordJson(*options.pose.time_s) : RecordJson();
    json["clip"] = options.pose.clip;
    json["fps"] = options.fps;
    return json;
}

RenderOptions options_of(const RecordJson& json) {
    RenderOptions options;
    json.at("scene").get_to(options.scene.files);
    json.at("search_path").get_to(options.scene.import.search_paths);
    json.at("importer").get_to(options.scene.import.importers);
    json.at("device").get_to(options.trace.device);
    json.at("accel").get_to(options.trace.accel);
    json.at("set").get_to(options.trace.sets);
    json.at("settings").get_to(options.trace.settings);
    json.at("all_aovs").get_to(options.all_aovs);
    options.crop = json.value("crop", "");  // these three are not in records of earlier versions
    options.error = json.value("error", 0.0);
    options.time_budget_s = json.value("time_budget", 0.0);
    json.at("camera").get_to(options.trace.camera);
    json.at("light").get_to(options.trace.light);
    json.at("preset").get_to(options.trace.preset);
    json.at("frames").get_to(options.frames);
    if (!json.at("time").is_null()) options.pose.time_s = json.at("time").get<double>();
    json.at("clip").get_to(options.pose.clip);
    json.at("fps").get_to(options.fps);
    return options;
}

}  // namespace

std::string record_path(const std::string& picture) {
    const size_t dot = picture.rfind('.'), slash = picture.rfind('/');
    const bool ends = dot != std::string::npos && (slash == std::string::npos || dot > slash);
    return picture.substr(0, ends ? dot : picture.size()) + ".json";
}

void write_record(const FrameRecord& record, const std::string& path) {
    const RecordJson json = {{"clarity_frame", 1},
                             {"frame", record.frame},
                             {"picture", record.picture},
                             {"digest", record.digest},
                             {"pixels", record.pixels},
                             {"file_digest", record.file_digest},
                             {"seconds", record.seconds},
                             {"samples", record.samples},
                             {"samples_of_checkpoint", record.of_checkpoint},
                             {"host", record.host},
                             {"device", record.device},
                             {"version", CLARITY_VERSION},
                             {"command", record.command},
                             {"options", options_json(record.options)}};
    write_text_file(path, json.dump(2, ' ', false, RecordJson::error_handler_t::replace) + "\n");
}

FrameRecord read_record(const std::string& path) {
    const std::string text = read_file(path, kMaxTextFileBytes, Exit::failed);
    try {
        const RecordJson json = RecordJson::parse(text);
        if (json.at("clarity_frame").get<int>() != 1) throw Error(Exit::failed, path + ": is a record of a newer version");
        FrameRecord record;
        json.at("frame").get_to(record.frame);
        json.at("picture").get_to(record.picture);
        json.at("digest").get_to(record.digest);
        json.at("pixels").get_to(record.pixels);
        json.at("file_digest").get_to(record.file_digest);
        json.at("seconds").get_to(record.seconds);
        json.at("samples").get_to(record.samples);
        json.at("samples_of_checkpoint").get_to(record.of_checkpoint);
        json.at("host").get_to(record.host);
        json.at("device").get_to(record.device);
        json.at("command").get_to(record.command);
        record.options = options_of(json.at("options"));
        return record;
    } catch (const RecordJson::exception&) {
        throw Error(Exit::failed,
                    path + ": is no record of a frame, as `clarity render --frames` writes it beside each picture");
    }
}

bool is_rendered(const std::string& picture, const std::string& digest) {
    const std::string path = record_path(picture);
    std::error_code error;
    if (!std::filesystem::is_regular_file(picture, error) || !std::filesystem::is_regular_file(path, error)) return false;
    try {
        const FrameRecord record = read_record(path);
        return record.picture == std::filesystem::path(picture).filename().string() && record.digest == digest &&
               record.file_digest == digest_of_file(picture);
    } catch (const Error&) {  // a damaged record is as good as none
        return false;
    }
}

std::string render_words(const RenderOptions& options, std::optional<int> frame) {
    std::string line = "clarity render";
    const auto add = [&](const std::string& option, const std::string& value) {
        if (!value.empty()) line += " " + option + " " + shell_word(value);
    };
    for (const std::string& file : options.scene.files) line += " " + shell_word(file);
    for (const std::string& folder : options.scene.import.search_paths) add("--search-path", folder);
    for (const std::string& words : options.scene.import.importers) add("--importer", words);
    add("--preset", options.trace.preset);
    add("--accel", options.trace.accel);
    add("--crop", options.crop);
    if (options.error > 0) add("--error", exact_text(options.error));
    if (options.time_budget_s > 0) add("--time-budget", exact_text(options.time_budget_s));
    add("--camera", options.trace.camera);
    add("--light", options.trace.light);
    for (const std::string& word : options.trace.sets) add("--set", word);
    for (const auto& [key, value] : options.trace.settings)
        if (!options.all_aovs || key != "aov") add("--set", key + "=" + value);
    if (options.all_aovs) add("--aov", "all");
    if (frame) add("--frames", std::to_string(*frame));
    if (options.fps > 0) add("--fps", exact_text(options.fps));
    if (options.pose.time_s) line += " --time=" + exact_text(*options.pose.time_s);
    add("--clip", options.pose.clip);
    return line;
}

}  // namespace clarity
