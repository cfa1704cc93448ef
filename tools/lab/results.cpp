#include "tools/lab/results.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <tuple>

#include "base/error.hpp"
#include "base/files/read_file.hpp"
#include "base/text.hpp"

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

constexpr double kAlike = 0.02;  // share of work within which two submissions are about the same

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<style>
body { font: 16px/1.5 sans-serif; max-width: 46rem; margin: 2rem auto; padding: 0 1rem; color: #222; background: #fff }
table { border-collapse: collapse; width: 100% }
th, td { padding: .3rem .6rem; text-align: right; border-bottom: 1px solid #ddd; font-variant-numeric: tabular-nums }
th:nth-child(2), td:nth-child(2) { text-align: left }
tr.none td { color: #767676 }
@media (prefers-color-scheme: dark) { body { color: #ddd; background: #181818 } th, td { border-color: #444 } tr.none td { color: #999 } }
</style>
)";

std::string cell(const char* format, double value) {
    char text[40];
    std::snprintf(text, sizeof text, format, value);
    return "<td>" + std::string(text) + "</td>";
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

std::vector<BoardRow> read_board(const std::string& folder) {
    std::vector<BoardRow> rows;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
        if (entry.path().extension() != ".json" || entry.path().filename().string().front() == '.') continue;
        const nlohmann::json json =
            nlohmann::json::parse(read_file(entry.path().string(), kMaxTextFileBytes, Exit::failed), nullptr, false);
        if (!json.is_object() || !json.contains("submission")) continue;
        rows.push_back({json.value("submission", ""), json.value("work", 0.0), json.value("checks", 0.0),
                        json.value("counts", 0.0), json.value("speed", 0.0), json.value("total", 0.0)});
    }
    if (rows.empty())
        throw Error(Exit::usage,
                    folder + ": there is no record of a submission; `clarity lab grade ... -o " + folder + "` writes them");
    const auto key = [](const BoardRow& row) { return std::tuple(row.work > 0 ? row.work : 1e300, -row.total, row.name); };
    std::sort(rows.begin(), rows.end(), [&](const BoardRow& a, const BoardRow& b) { return key(a) < key(b); });
    double best = 0;
    for (size_t i = 0; i < rows.size() && rows[i].work > 0; ++i) {
        const bool shares = i > 0 && rows[i].work <= best * (1 + kAlike);
        if (!shares) best = rows[i].work;
        rows[i].rank = shares ? rows[i - 1].rank : static_cast<unsigned>(i + 1);
    }
    return rows;
}

std::string board_html(const std::string& title, const std::vector<BoardRow>& rows) {
    std::string text = kHead + ("<title>" + markup_line(title)) + "</title></head><body>\n<h1>" + markup_line(title) +
                       "</h1>\n<p>Work is what a ray costs, nodes and tests, by that of the reference solution: less is "
                       "better. Submissions within "
                       "2 % of the best of a rank share it.</p>\n<table><tr><th>rank</th><th>submission</th><th>work</th>"
                       "<th>checks</th><th>counts</th><th>speed</th><th>total</th></tr>\n";
    for (const BoardRow& row : rows)
        text += (row.rank > 0 ? "<tr>" + cell("%.0f", row.rank) : "<tr class=\"none\"><td>–</td>") + "<td>" +
                markup_line(row.name) + "</td>" + (row.work > 0 ? cell("%.2f", row.work) : "<td>–</td>") +
                cell("%.1f", row.checks) + cell("%.1f", row.counts) + cell("%.1f", row.speed) + cell("%.1f", row.total) +
                "</tr>\n";
    return text + "</table></body></html>\n";
}

}  // namespace clarity::lab
