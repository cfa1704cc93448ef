// The Plugins tab: the devices, plugins and kernels that the program found, and why others are missing.
#include <imgui.h>

#include <map>

#include "ui/panel/panel.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

void name_text(const std::string& name, const std::string& what) {
    ImGui::PushFont(fonts().bold);
    ImGui::TextUnformatted(name.c_str());
    ImGui::PopFont();
    ImGui::SameLine();
    dim_text(what);
}

// Draws a path. If it is too long, it is cut at the front, which says least.
void path_text(const std::string& path) {
    ImGui::PushStyleColor(ImGuiCol_Text, colors::kDim);
    ImGui::TextUnformatted(cut_front_to(path, ImGui::GetContentRegionAvail().x).c_str());
    ImGui::PopStyleColor();
    tooltip(path);
}

void gap() {
    ImGui::Dummy({0, 5 * ui_scale()});
}

void device_list(Session& session) {
    const auto devices = session.devices();
    const auto ready = session.ready();
    if (!devices) return dim_text("looking for devices\u2026");
    if (devices->empty())
        wrapped_text(
            "No OpenCL device was found: install a driver (pocl-opencl-icd for the CPU), then start again; `clarity "
            "devices` says what is missing.",
            colors::kAmber);
    for (const DeviceInfo& device : *devices) {
        const auto uses = [&](const ReadySide& side) { return side.uses(device); };
        const bool used = ready && (uses(ready->main) || (ready->other && uses(*ready->other)));
        name_text(device.id(), std::string(device.gpu ? "GPU" : device.cpu ? "CPU" : "accelerator") + (used ? ", in use" : ""));
        wrapped_text(device.name);
        dim_text(device.platform + ", driver " + device.driver + ", " + std::to_string(device.compute_units) + " units, " +
                 bytes_text(static_cast<double>(device.global_bytes)));
        gap();
    }
}

void plugin_rows(const PluginRecord& record) {
    const rt_plugin* plugin = record.plugin;
    if (plugin) {
        const char* kind = plugin->accel ? "acceleration structure" : plugin->importer ? "importer" : "shape";
        name_text(plugin->id, std::string(kind) + "  " + plugin->version);
        wrapped_text(plugin->name);
        std::string extensions;
        if (plugin->importer)
            for (const char* const* e = plugin->importer->extensions; e && *e; ++e) extensions += std::string(" .") + *e;
        if (!extensions.empty()) dim_text("files:" + extensions);
        if (plugin->reference) dim_text(plugin->reference);
        if (record.replaced > 0) dim_text("built again and replaced " + plural(record.replaced, "time"));
        if (record.shadowed) wrapped_text("not used: an earlier library has the same id", colors::kAmber);
    } else {
        wrapped_text("refused: " + record.why, colors::kRed);
    }
    path_text(record.path);
    gap();
}

void kernel_rows(const Session& session) {
    std::map<std::string, size_t> folders;
    for (const std::string& file : session.kernels().files()) ++folders[file.substr(0, file.find_last_of('/'))];
    if (folders.empty())
        return dim_text(
            "The kernels inside the program. CLARITY_KERNEL_PATH names a folder laid out as cl/ whose files come first, "
            "and are watched.");
    dim_text("A file saved here is compiled and swapped in by itself:");
    for (const auto& [folder, count] : folders) path_text(folder);
}

}  // namespace

void draw_plugins_tab(Session& session) {
    section("DEVICES");
    device_list(session);
    const std::vector<PluginRecord> records = session.plugins().records();
    size_t refused = 0;
    for (const PluginRecord& record : records) refused += record.plugin == nullptr;
    if (refused > 0) section("REFUSED LIBRARIES");
    for (const PluginRecord& record : records)
        if (!record.plugin) plugin_rows(record);
    section("PLUGINS");
    if (records.empty()) dim_text("no plugin library was found");
    for (const PluginRecord& record : records)
        if (record.plugin) plugin_rows(record);
    section("KERNELS");
    kernel_rows(session);
}

}  // namespace clarity::ui
