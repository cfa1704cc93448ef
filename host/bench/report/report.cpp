#include "bench/report/report.hpp"

#include <filesystem>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "bench/output/output.hpp"
#include "bench/report/report_page.hpp"

namespace clarity::bench {

void write_report(const std::string& folder, const BenchReport& report) {
    namespace fs = std::filesystem;
    std::error_code error;
    fs::create_directories(folder, error);
    if (error || !fs::is_directory(folder))
        throw Error(Exit::failed, folder + ": cannot make this folder for the report (" +
                                      (error ? error.message() : "a file of that name is in the way") +
                                      "); name another with --report");
    const fs::path base(folder);
    write_text_file((base / "bench.json").string(), bench_json(report));
    write_text_file((base / "bench.csv").string(), bench_csv(report));
    write_text_file((base / "index.html").string(), report_page(report));
}

}  // namespace clarity::bench
