#include "bench/output/rows_file.hpp"

#include <filesystem>

#include "bench/output/output.hpp"

namespace clarity::bench {

RowsFile::RowsFile(std::string path) : path_(std::move(path)) {
    std::error_code error;
    if (!std::filesystem::exists(path_, error) || std::filesystem::is_regular_file(path_, error))
        file_ = std::make_unique<OutputFile>(path_);
}

RowsFile::~RowsFile() {
    if (!file_ || !any_ || torn_) return;
    try {
        file_->write("\n]\n", 3);
        file_->commit();
    } catch (...) {
        // A destructor must not throw. The run has already failed with a message of its own.
    }
}

void RowsFile::add(const BenchReport& report) {
    if (!file_ || report.records.empty()) return;
    const std::string text = (any_ ? ",\n" : "[\n") + bench_json_row(report, report.records.back());
    torn_ = true;
    file_->write(text.data(), text.size());
    torn_ = false;
    any_ = true;
}

void RowsFile::finish(const BenchReport& report) {
    write_text_file(path_, bench_json(report));
    file_.reset();
}

}  // namespace clarity::bench
