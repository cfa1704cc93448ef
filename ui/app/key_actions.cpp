#include "ui/app/key_actions.hpp"

#include <cstdio>

#include "ui/session/session.hpp"
#include "ui/session/session_output.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

void print_frame_rate(KeyTarget& to) {
    std::printf("%s\n", frame_rate_line(to.session).c_str());
    std::fflush(stdout);
}

void toggle_inspector(KeyTarget& to) {
    to.state.inspect_hover = !to.state.inspect_hover;
    if (to.state.inspect_hover) to.state.show_tab(Tab::inspect);
}

void add_bookmark(KeyTarget& to) {
    auto& bookmarks = to.state.bookmarks;
    bookmarks.push_back({"view " + std::to_string(bookmarks.size() + 1), to.session.desired.camera, to.session.desired.pose});
}

void go_to_next_bookmark(KeyTarget& to) {
    std::vector<Camera> cameras;
    std::vector<PoseTime> poses;
    if (to.session.ready()) cameras = to.session.ready()->cameras;
    poses.resize(cameras.size());
    for (const Bookmark& bookmark : to.state.bookmarks) {
        cameras.push_back(bookmark.camera);
        poses.push_back(bookmark.pose);
    }
    if (cameras.empty()) return;
    const size_t next = to.state.next_bookmark++ % cameras.size();
    go_to(to.session, cameras[next], poses[next]);
}

void toggle_playing(KeyTarget& to) {
    if (to.session.playback().any())
        to.session.playback().toggle(to.session.desired);
    else
        to.state.notify("this scene has no clip to play");
}

void close_or_cancel(KeyTarget& to) {
    if (to.state.keys_open)
        to.state.keys_open = false;
    else if (to.state.browser_open)
        to.state.browser_open = false;
    else if (to.session.sequence().running())
        to.session.sequence().stop(to.session);
    else
        to.session.cancel();
}

}  // namespace clarity::ui
