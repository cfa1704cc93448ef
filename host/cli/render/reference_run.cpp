#include "cli/render/reference_run.hpp"

#include "base/error.hpp"
#include "render/compare/reference_picture.hpp"
#include "render/multi/multi_frame_renderer.hpp"
#include "render/settings/aov.hpp"

namespace clarity {

ReferenceRun::ReferenceRun(const std::string& file, const Settings& settings)
    : settings_(settings), file_(file), reference_(read_reference(file, settings)) {
    if (!find_aov(settings.aov).is_color())
        throw Error(Exit::usage, "--reference " + file + ": is compared with colours; leave out --aov " + settings.aov);
}

void ReferenceRun::offer(MultiFrameRenderer& frames, unsigned samples, bool finished) {
    const unsigned last = points_.empty() ? 0 : points_.back().samples;
    if (samples < 2 * last && !(finished && samples > last)) return;
    points_.push_back({samples, picture_errors(frames.read_picture(settings_), reference_)});
}

double ReferenceRun::slope() const {
    std::vector<std::pair<unsigned, double>> errors;
    for (const Point& point : points_) errors.emplace_back(point.samples, point.errors.rmse);
    return error_slope(errors);
}

}  // namespace clarity
