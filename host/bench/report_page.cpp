#include "bench/report_page.hpp"

#include "bench/output.hpp"

namespace clarity {

std::string report_page(const BenchReport& report) {
    std::string text = bench_table(report), escaped;
    for (const char c : text) escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
    return "<!DOCTYPE html>\n<html><head><meta charset=\"utf-8\"/><title>Clarity bench</title></head><body><pre>" + escaped + "</pre></body></html>\n";
}

}  // namespace clarity
