#include "ui/app/window_main.hpp"

#include "ui/app/app.hpp"

namespace clarity::ui {

int ui_main(const ViewOptions& options) {
    App app(options);
    return app.run();
}

}  // namespace clarity::ui
