// Edits of files: their numbers, which count the objects of one file, become those of the scene.
#include "base/error.hpp"
#include "base/numbers.hpp"
#include "import/sink/scene_builder.hpp"

namespace clarity::import {

EditOf edit_number(const std::string& key, rt_u32& number) {
    if (key == "sky" || key.rfind("sky.", 0) == 0) return EditOf::sky;
    const size_t first = key.find('.'), last = key.find('.', first + 1);
    if (first == std::string::npos || !read_number(key.substr(first + 1, last - first - 1), number)) return EditOf::nothing;
    const std::string what = key.substr(0, first);
    return what == "instance"   ? EditOf::instance
           : what == "material" ? EditOf::material
           : what == "light"    ? EditOf::light
                                : EditOf::nothing;
}

std::string with_number(const std::string& key, rt_u32 number) {
    const size_t first = key.find('.'), last = key.find('.', first + 1);
    return key.substr(0, first + 1) + std::to_string(number) + (last == std::string::npos ? "" : key.substr(last));
}

// instances: the number in `into` of each of the file's, or RT_NONE. lights: those that `into` had before.
void SceneBuilder::place_edits(const std::string& from, const FileContent& content, const std::vector<rt_u32>& instances,
                               size_t lights, FileContent& into) {
    const bool is_root = &into == &world_;
    size_t left_out = 0;
    for (SceneEdit edit : content.edits) {
        rt_u32 number = 0;
        const EditOf what = edit_number(edit.key, number);
        const auto refuse = [&](const char* objects, size_t count) {
            throw Error(Exit::import_failed, edit.where + ": `" + edit.key + "`: there are " + std::to_string(count) + " " +
                                                 objects + ", counted from 0");
        };
        if (what == EditOf::instance) {
            if (number >= instances.size()) refuse("instances", instances.size());
            if (instances[number] == RT_NONE) continue;
            number = instances[number];
        } else if (what == EditOf::material) {
            if (number > 0) number += content.first_material - 1;
            if (number >= scene_.materials.size()) refuse("materials", scene_.materials.size() - content.first_material + 1);
        } else if (is_root && what == EditOf::sky) {
            into.edits.push_back(std::move(edit));
            continue;
        } else if (is_root) {
            number += static_cast<rt_u32>(lights);
        } else {
            ++left_out;
            continue;
        }
        edit.key = with_number(edit.key, number);
        into.edits.push_back(std::move(edit));
    }
    if (left_out > 0)
        warn(from, std::to_string(left_out) + " edits of lights and sky are left out, because another file loads it");
}

}  // namespace clarity::import
