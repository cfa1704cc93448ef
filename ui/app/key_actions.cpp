#include "ui/app/key_actions.hpp"

#include <cstdio>

#include "ui/session/session.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

void print_frame_rate(KeyTarget& to) {
    std::printf("%s\n", to.session.frame_rate_line().c_str());
    std::fflush(stdout);
}

void toggle_inspector(KeyTarget& to) {
    to.state.inspect_hover = !to.state.inspect_hover;
    if (to.state.inspect_hover) to.state.show_tab(Tab::inspect);
}

void add_bookmark(KeyTarget& to) {
    auto& bookmarks = to.state.bookmarks;
    bookmarks.push_back({"view " + std::to_string(bookmarks.size() + 1), to.session.desired.camera});
}

void go_to_next_bookmark(KeyTarget& to) {
    std::vector<Camera> cameras;
    if (to.session.ready()) cameras = to.session.ready()->loaded->scene->cameras;
    for (const Bookmark& bookmark : to.state.bookmarks) cameras.push_back(bookmark.camera);
    if (!cameras.empty()) to.session.desired.camera = cameras[to.state.next_bookmark++ % cameras.size()];
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
