#include "ui/browser/file_browser.hpp"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <memory>
#include <set>
#include <utility>

#include "ui/browser/file_listing.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/imgui_calls.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

struct Browser {
    FolderReader reader;
    bool was_open = false, all_files = false, moved = false;
    std::string text, failure;
    std::string listed;        // folder and word for which `rows` was made
    std::vector<size_t> rows;  // indices into the listing
    std::shared_ptr<const Listing> listing;
    int highlighted = 0;           // index into `rows`
    std::set<std::string> marked;  // paths chosen with Ctrl
};
Browser& browser() {
    static Browser it;
    return it;
}

std::vector<std::string> extensions_for(const Session& session, BrowseFor what) {
    if (what == BrowseFor::preset) return {"json"};
    if (what == BrowseFor::picture)
        return {"png", "jpg", "jpeg", "bmp", "tga", "psd", "gif", "hdr", "exr", "pfm", "ppm", "pgm"};
    std::vector<std::string> all;
    for (const rt_plugin* plugin : session.plugins().importers())
        for (const char* const* e = plugin->importer->extensions; e && *e; ++e) {
            all.emplace_back(*e);
            all.push_back(std::string(*e) + ".gz");
        }
    return all;
}

std::string first_folder(const Session& session, const UiState& state) {
    std::error_code error;
    if (state.browse_for == BrowseFor::folder_of_pictures) return state.pictures_folder;
    if (state.browse_for == BrowseFor::preset && fs::is_directory(state.presets_folder, error)) return state.presets_folder;
    if (!state.browser_folder.empty() && fs::is_directory(state.browser_folder, error)) return state.browser_folder;
    const auto files = session.files();
    return files.empty() ? home_folder() : parent_folder(files.front());
}

void go_to(UiState& state, const std::string& folder) {
    Browser& b = browser();
    state.browser_folder = absolute_folder(folder);
    b.text.clear();
    b.failure.clear();
    b.highlighted = 0;
    b.moved = true;
}

void finish(Session& session, UiState& state, std::vector<std::string> paths) {
    if (state.browse_for == BrowseFor::scene)
        session.open(std::move(paths));
    else if (state.browse_for == BrowseFor::preset)
        attempt(session, [&] { session.load_preset(paths.front()); });
    else if (state.browse_for == BrowseFor::picture)
        attempt(session, [&] { give_picture(session, state.picture_for.first, state.picture_for.second, paths.front()); });
    state.browser_open = false;
}

// Accepts the choice, for Enter, a double click or the button.
void accept(Session& session, UiState& state) {
    Browser& b = browser();
    if (!b.marked.empty()) return finish(session, state, {b.marked.begin(), b.marked.end()});
    const Typed typed = split_typed(b.text, state.browser_folder);
    const std::string exact = joined_path(typed.folder, typed.word);
    std::error_code error;
    if (!typed.word.empty() && fs::is_regular_file(exact, error)) return finish(session, state, {exact});
    if (b.listing && b.highlighted >= 0 && static_cast<size_t>(b.highlighted) < b.rows.size()) {
        const FileEntry& entry = b.listing->entries[b.rows[static_cast<size_t>(b.highlighted)]];
        const std::string path = joined_path(b.listing->folder, entry.name);
        return entry.folder ? go_to(state, path) : finish(session, state, {path});
    }
    if (typed.word.empty() && fs::is_directory(typed.folder, error)) return go_to(state, typed.folder);
    b.failure = exact + ": there is no such file";
}

int on_field(ImGuiInputTextCallbackData* data) {
    Browser& b = browser();
    if (data->EventFlag == ImGuiInputTextFlags_CallbackCompletion && b.listing) {
        const std::string longer = complete(*b.listing, std::string(data->Buf, static_cast<size_t>(data->BufTextLen)));
        data->DeleteChars(0, data->BufTextLen);
        data->InsertChars(0, longer.c_str());
    } else if (data->EventFlag == ImGuiInputTextFlags_CallbackHistory) {
        b.highlighted += data->EventKey == ImGuiKey_UpArrow ? -1 : 1;
        b.moved = true;
    }
    return 0;
}

std::string date_text(int64_t seconds) {
    const auto time = static_cast<std::time_t>(seconds);
    std::tm local{};
    char text[32] = "";
    if (seconds > 0 && localtime_r(&time, &local)) std::strftime(text, sizeof text, "%Y-%m-%d", &local);
    return text;
}

void head_row(Session& session, UiState& state) {
    if (button("\u2191##up", "the folder above (Backspace)"))
        go_to(state, parent_folder(split_typed(browser().text, state.browser_folder).folder));
    note_rect("parent folder");
    ImGui::SameLine();
    if (button("Home", home_folder())) go_to(state, home_folder());
    ImGui::SameLine();
    ImGui::SetNextItemWidth(110 * ui_scale());
    if (ImGui::BeginCombo("##recent", "Recent", ImGuiComboFlags_HeightLarge)) {
        for (const std::string& file : state.recent_files) {
            ImGui::PushID(file.c_str());
            if (ImGui::Selectable(file_name(file).c_str())) {
                if (state.browse_for == BrowseFor::scene)
                    finish(session, state, {file});
                else
                    go_to(state, parent_folder(file));
            }
            tooltip(file);
            ImGui::PopID();
        }
        if (state.recent_files.empty()) ImGui::TextUnformatted("none yet");
        ImGui::EndCombo();
    }
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::PushFont(fonts().bold);
    const std::string folder = split_typed(browser().text, state.browser_folder).folder;
    ImGui::TextUnformatted(cut_front_to(folder, ImGui::GetContentRegionAvail().x).c_str());
    ImGui::PopFont();
    tooltip(folder);
}

// Whether the last click was on this window and may be the first half of a double click. If the path field took the keyboard
// between the halves, it could become active in the frame of the second press, and ImGui would give that press to no row.
bool may_double_click() {
    const ImGuiIO& io = ImGui::GetIO();
    const ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize(), click = io.MouseClickedPos[0];
    const bool here = click.x >= low.x && click.y >= low.y && click.x < low.x + size.x && click.y < low.y + size.y;
    return here && ImGui::GetTime() - io.MouseClickedTime[0] < 2 * io.MouseDoubleClickTime;
}

// Whenever nothing else has the keyboard, the path field takes it.
void field_row(Session& session, UiState& state) {
    Browser& b = browser();
    const bool was_empty = b.text.empty();
    if (!ImGui::IsAnyItemActive() && !may_double_click() && ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows))
        ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(-FLT_MIN);
    const bool entered = ImGui::InputTextWithHint(
        "##typed", "type to search, or a path; Tab completes, arrows choose, Enter opens", &b.text,
        ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackCompletion | ImGuiInputTextFlags_CallbackHistory,
        on_field);
    note_rect("file name");
    if (ImGui::IsItemEdited()) {
        b.highlighted = 0;
        b.failure.clear();
        b.moved = true;
    }
    if (entered) accept(session, state);
    if (was_empty && b.text.empty() && key_pressed(ImGuiKey_Backspace)) go_to(state, parent_folder(state.browser_folder));
}

void update_rows(const Session& session, const UiState& state) {
    Browser& b = browser();
    const Typed typed = split_typed(b.text, state.browser_folder);
    DesiredListing desired{typed.folder, extensions_for(session, state.browse_for),
                           state.browse_for != BrowseFor::folder_of_pictures};
    if (b.all_files) desired.extensions.clear();
    const auto listing = b.reader.get(desired);
    const std::string key = typed.folder + "\n" + typed.word;
    if (listing != b.listing || key != b.listed) {
        b.listing = listing;
        b.listed = key;
        b.rows = listing ? matching(*listing, typed.word) : std::vector<size_t>();
    }
    b.highlighted = std::clamp(b.highlighted, 0, std::max(0, static_cast<int>(b.rows.size()) - 1));
}

void entry_row(Session& session, UiState& state, int row) {
    Browser& b = browser();
    const FileEntry& entry = b.listing->entries[b.rows[static_cast<size_t>(row)]];
    const std::string path = joined_path(b.listing->folder, entry.name);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::PushID(row);
    const bool chosen = b.marked.empty() ? row == b.highlighted : b.marked.count(path) > 0;
    const std::string name = (entry.folder ? "\u25b8 " : "    ") + entry.name;
    const float room = ImGui::GetContentRegionAvail().x;
    const std::string shown = cut_to(name, room);
    if (entry.folder) ImGui::PushStyleColor(ImGuiCol_Text, colors::kAccent);
    const bool clicked = ImGui::Selectable((shown + "##entry").c_str(), chosen,
                                           ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowDoubleClick);
    if (entry.folder) ImGui::PopStyleColor();
    note_rect(entry.name);
    if (shown != name) tooltip(entry.name);
    if (clicked) {
        b.highlighted = row;
        const bool more = ImGui::GetIO().KeyCtrl && !entry.folder && state.browse_for == BrowseFor::scene;
        if (!more) b.marked.clear();
        if (more && !b.marked.erase(path)) b.marked.insert(path);
        if (ImGui::IsMouseDoubleClicked(0) && !more) {
            b.text.clear();
            entry.folder ? go_to(state, path) : finish(session, state, {path});
        }
    }
    ImGui::TableNextColumn();
    ImGui::PushStyleColor(ImGuiCol_Text, colors::kDim);
    if (!entry.folder) ImGui::TextUnformatted(bytes_text(static_cast<double>(entry.bytes)).c_str());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(date_text(entry.modified_s).c_str());
    ImGui::PopStyleColor();
    ImGui::PopID();
}

void list_rows(Session& session, UiState& state, float height) {
    Browser& b = browser();
    ImGui::PushStyleColor(ImGuiCol_ChildBg, colors::kGround);
    ImGui::BeginChild("list", {0, height}, false);
    if (b.listing && !b.listing->failure.empty()) {
        wrapped_text(b.listing->folder + ": " + b.listing->failure + "; choose another folder", colors::kAmber);
    } else if (b.rows.empty()) {
        dim_text(b.reader.reading() ? "reading\u2026"
                 : b.all_files      ? "nothing here"
                                    : "nothing here that can be opened; \"All files\" below shows the rest");
    } else if (ImGui::BeginTable("entries", 3, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) {
        ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("size", ImGuiTableColumnFlags_WidthFixed, ImGui::CalcTextSize("1023.9 MiB").x);
        ImGui::TableSetupColumn("date", ImGuiTableColumnFlags_WidthFixed, ImGui::CalcTextSize("2000-00-00 ").x);
        const float line = ImGui::GetTextLineHeight() + 2 * ImGui::GetStyle().CellPadding.y;
        if (b.moved) {
            const float at = static_cast<float>(b.highlighted) * line;
            if (at < ImGui::GetScrollY()) ImGui::SetScrollY(at);
            if (at + line > ImGui::GetScrollY() + height) ImGui::SetScrollY(at + line - height);
            b.moved = false;
        }
        ImGuiListClipper clipper;
        clipper.Begin(static_cast<int>(b.rows.size()), line);
        const auto listing = b.listing;  // keeps the listing: a click may change to another folder
        while (clipper.Step())
            for (int i = clipper.DisplayStart; i < clipper.DisplayEnd && static_cast<size_t>(i) < b.rows.size(); ++i)
                entry_row(session, state, i);
        ImGui::EndTable();
    }
    ImGui::EndChild();
    ImGui::PopStyleColor();
}

void foot_row(Session& session, UiState& state) {
    Browser& b = browser();
    const bool folder = state.browse_for == BrowseFor::folder_of_pictures;
    if (!b.failure.empty()) wrapped_text(b.failure, colors::kAmber);
    const std::string what = folder                ? "Choose this folder"
                             : b.marked.size() > 1 ? "Open " + std::to_string(b.marked.size()) + " files"
                                                   : std::string("Open");
    if (!folder) {
        ImGui::Checkbox("All files", &b.all_files);
        note_rect("All files");
        tooltip("also those that no importer claims");
        ImGui::SameLine();
    }
    const ImGuiStyle& style = ImGui::GetStyle();
    const float cancel = ImGui::CalcTextSize("Cancel").x + 2 * style.FramePadding.x;
    const float open = std::max(ImGui::CalcTextSize(what.c_str()).x + 2 * style.FramePadding.x, 90 * ui_scale());
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x - open - cancel - style.ItemSpacing.x);
    if (button((what + "##accept").c_str(), {}, open)) {
        if (folder) {
            state.pictures_folder = split_typed(b.text, state.browser_folder).folder;
            state.browser_open = false;
        } else {
            accept(session, state);
        }
    }
    note_rect("accept");
    ImGui::SameLine();
    if (button("Cancel##browser", {}, cancel)) state.browser_open = false;
}

const char* title_of(BrowseFor what) {
    switch (what) {
        case BrowseFor::scene:
            return "Open a model or a scene";
        case BrowseFor::preset:
            return "Load a preset";
        case BrowseFor::picture:
            return "A picture for the material";
        case BrowseFor::folder_of_pictures:
            break;
    }
    return "Folder for pictures";
}

}  // namespace

void stop_file_browser() {
    browser().reader.stop();
}

void draw_file_browser(const Rect& area, Session& session, UiState& state) {
    Browser& b = browser();
    if (!state.browser_open) {
        if (std::exchange(b.was_open, false)) state.browse_for = BrowseFor::scene;
        return;
    }
    const bool appears = !std::exchange(b.was_open, true);
    if (appears) {
        go_to(state, first_folder(session, state));
        b.marked.clear();
        b.reader.refresh();
        ImGui::SetNextWindowFocus();
    }
    const float scale = ui_scale();
    const float width = std::min(700 * scale, area.width - 24 * scale),
                height = std::min(560 * scale, area.height - 24 * scale);
    ImGui::SetNextWindowPos({area.x + area.width / 2, area.y + area.height / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({width, height});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, colors::kHudGround);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 8 * scale);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
    ImGui::Begin(
        "Browser", nullptr,
        ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
    section(title_of(state.browse_for));
    head_row(session, state);
    field_row(session, state);
    update_rows(session, state);
    float foot = ImGui::GetFrameHeightWithSpacing() + ImGui::GetStyle().ItemSpacing.y;
    if (!b.failure.empty()) foot += 2 * ImGui::GetTextLineHeightWithSpacing();
    list_rows(session, state, std::max(ImGui::GetContentRegionAvail().y - foot, 60 * scale));
    foot_row(session, state);
    ImGui::End();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor();
}

}  // namespace clarity::ui
