#include "tools/bench/output/rows_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "tools/bench/output/output.hpp"

namespace clarity::bench {

RowsFile::RowsFile(std::string path) : path_(std::move(path)), part_(path_ + ".part") {
    std::error_code error;
    if (std::filesystem::exists(path_, error) && !std::filesystem::is_regular_file(path_, error)) return;
    file_ = std::fopen(part_.c_str(), "we");
    if (!file_) fail("cannot be created");
}

RowsFile::~RowsFile() {
    if (!file_) return;
    if (!any_) {
        remove_part();
        return;
    }
    if (torn_) {
        std::fclose(file_);  // the file keeps the rows before the torn one
        return;
    }
    const bool closed = std::fputs("\n]\n", file_) >= 0;
    if (std::fclose(file_) == 0 && closed) std::rename(part_.c_str(), path_.c_str());
}

void RowsFile::add(const BenchReport& report) {
    if (!file_ || report.records.empty()) return;
    const std::string text = (any_ ? ",\n" : "[\n") + bench_json_row(report, report.records.back());
    torn_ = true;
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size() || std::fflush(file_) != 0) fail("cannot be written");
    torn_ = false;
    any_ = true;
}

void RowsFile::finish(const BenchReport& report) {
    write_text_file(path_, bench_json(report));
    if (file_) remove_part();
}

void RowsFile::remove_part() {
    std::fclose(file_);
    file_ = nullptr;
    std::remove(part_.c_str());
}

void RowsFile::fail(const char* what) const {
    throw Error(Exit::failed, part_ + ": " + what + ": " + std::strerror(errno) +
                                  ": check the folder and the space on its disk, or name another file with --json");
}

}  // namespace clarity::bench
