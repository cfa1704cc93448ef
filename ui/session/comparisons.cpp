#include "ui/session/comparisons.hpp"

#include <algorithm>

#include "scene/sky_kinds.hpp"

namespace clarity::ui {
namespace {

// Whether all settings that `counts` selects are equal.
template <class Counts>
bool same_where(const Settings& a, const Settings& b, const Counts& counts) {
    const auto& table = settings_table();
    return std::all_of(table.begin(), table.end(), [&](const Setting& row) { return !counts(row) || row.equal(a, b); });
}

bool prepares_same(const Side& a, const Side& b) {
    return a.device == b.device && a.settings.accel == b.settings.accel && a.settings.accel_params == b.settings.accel_params &&
           a.settings.optics == b.settings.optics &&
           same_where(a.settings, b.settings, [](const Setting& row) { return !row.at_once(); });
}

}  // namespace

bool same_light(const rt_light& a, const rt_light& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

bool same_edited_sky(const std::optional<SkyValues>& a, const std::optional<SkyValues>& b) {
    return a.has_value() == b.has_value() && (!a || same_sky(*a, *b));
}

bool same_view(const View& a, const View& b) {
    return same_camera(a.camera, b.camera) && a.background == b.background && a.ambient == b.ambient &&
           same_edited_sky(a.sky, b.sky) && same_bytes(a.lights, b.lights) && same_bytes(a.materials, b.materials);
}

// What of a request does not count here only says how it is prepared, or belongs to the files, of which a change has a
// revision.
static_assert(has_member_count<PrepareRequest, 11> && has_member_count<Side, 2>,
              "a new member is compared here, filled in by Session::desired_request() and taken back by cancel()");

bool prepares_same(const PrepareRequest& a, const PrepareRequest& b) {
    return prepares_same_but_pose(a, b) && same_pose(a.pose, b.pose) && same_edits(a, b) && a.apart == b.apart;
}

bool prepares_same_but_pose(const PrepareRequest& a, const PrepareRequest& b) {
    return a.files_revision == b.files_revision && a.kernel_revision == b.kernel_revision && prepares_same(a.main, b.main) &&
           a.other.has_value() == b.other.has_value() && (!a.other || prepares_same(*a.other, *b.other));
}

bool traces_same(const Settings& a, const Settings& b) {
    return same_where(a, b, [](const Setting& row) { return row.effect == Effect::frame; });
}

bool displays_same(const Settings& a, const Settings& b) {
    return same_where(a, b, [](const Setting& row) { return row.effect == Effect::display; });
}

}  // namespace clarity::ui
