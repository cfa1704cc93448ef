// report_style.hpp -- style sheet of a report, for light and dark screens, narrow screens, and paper.
#pragma once

namespace clarity::bench {

extern const char* const kReportStyle;

}  // namespace clarity::bench
