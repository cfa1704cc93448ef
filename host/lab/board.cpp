#include "lab/board.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <tuple>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/files/read_file.hpp"
#include "base/printable.hpp"

namespace clarity::lab {
namespace {

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
