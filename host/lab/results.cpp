#include "lab/results.hpp"

#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "base/files/read_file.hpp"

namespace clarity::lab {
namespace {

using nlohmann::ordered_json;

// Points to a tenth, so that sums of rows are the sum that is shown.
double tenths(double points) {
    return std::round(points * 10) / 10;
}
double total_of(const Marks& marks) {
    return tenths(marks.total());
}

std::string text_of(const Line& line) {
    std::string text = "tried: " + line.tried + "\nfound: " + line.found;
    if (!line.alone.empty()) text += "\nalone: " + line.alone;
    return text;
}

// What students print or name may hold any bytes.
std::string dump(const ordered_json& json, int indent) {
    return json.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace

std::string marks_text(const Lab& lab, const Marks& marks) {
    std::string text;
    char points[64];
    for (const Line& line : marks.lines) {
        std::snprintf(points, sizeof points, "%5.1f of %4.1f  ", line.points, line.most);
        text +=
            points + line.section + " " + line.name + (line.hidden ? " (hidden)" : "") + ": " + line.tried + ": " + line.found;
        if (!line.alone.empty() && line.points < line.most) text += "; alone: " + line.alone;
        text += "\n";
    }
    double most = 0;
    for (const Line& line : marks.lines) most += line.most;
    // What does not build has no further lines.
    if (most == 0) most = lab.points_checks + lab.points_answers + lab.points_counts + lab.points_speed;
    std::snprintf(points, sizeof points, "%5.1f of %.1f points  ", total_of(marks), tenths(most));
    return text + points + lab.title + "\n";
}

std::string gradescope_json(const Lab& lab, const Marks* marks) {
    ordered_json json;
    if (!marks) {
        json = {
            {"score", 0},
            {"output",
             "The grader did not come to its end: most likely the time limit was reached. Hand in again, or ask the teacher."},
            {"tests", ordered_json::array()}};
        return dump(json, 2) + "\n";
    }
    json["score"] = total_of(*marks);
    json["output"] = lab.title;
    json["tests"] = ordered_json::array();
    for (const Line& line : marks->lines)
        json["tests"].push_back({{"name", line.section + ": " + line.name},
                                 {"score", tenths(line.points)},
                                 {"max_score", tenths(line.most)},
                                 {"output", text_of(line)},
                                 {"visibility", line.hidden ? lab.hidden_visibility : lab.visibility}});
    json["leaderboard"] = ordered_json::array();
    if (marks->work > 0)
        json["leaderboard"].push_back(
            {{"name", "work by the reference's"}, {"value", std::round(marks->work * 100) / 100}, {"order", "asc"}});
    return dump(json, 2) + "\n";
}

std::string autolab_line(const Marks* marks) {
    ordered_json scores = ordered_json::object();
    for (const char* section : {"checks", "counts", "speed"}) scores[section] = marks ? tenths(marks->of(section)) : 0.0;
    ordered_json board = ordered_json::array();
    if (marks && marks->work > 0) board.push_back(std::round(marks->work * 100) / 100);
    return dump({{"scores", scores}, {"scoreboard", board}}, -1);
}

std::string record_json(const Lab& lab, const std::string& submission, const std::string& digest, const Marks& marks) {
    ordered_json lines = ordered_json::array();
    for (const Line& line : marks.lines)
        lines.push_back({{"section", line.section},
                         {"name", line.name},
                         {"points", tenths(line.points)},
                         {"most", tenths(line.most)},
                         {"hidden", line.hidden},
                         {"tried", line.tried},
                         {"found", line.found},
                         {"alone", line.alone}});
    const ordered_json json = {{"lab", lab.id},
                               {"digest", digest},
                               {"submission", submission},
                               {"total", total_of(marks)},
                               {"checks", tenths(marks.of("checks"))},
                               {"counts", tenths(marks.of("counts"))},
                               {"speed", tenths(marks.of("speed"))},
                               {"work", marks.work},
                               {"speed_ratio", marks.speed},
                               {"sandbox", marks.sandbox},
                               {"lines", lines}};
    return dump(json, 2) + "\n";
}

bool record_fits(const std::string& path, const std::string& digest) {
    std::string text;
    if (try_read_file(path, kMaxTextFileBytes, text)) return false;
    const ordered_json json = ordered_json::parse(text, nullptr, false);
    return json.is_object() && json.value("digest", "") == digest;
}

}  // namespace clarity::lab
