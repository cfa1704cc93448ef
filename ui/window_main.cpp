#include "ui/window_main.hpp"

#include "ui/app.hpp"

namespace clarity {

int ui_main(const ViewOptions& options) {
    App app(options);
    return app.run();
}

}  // namespace clarity
