// report_style.hpp -- how a report looks: on light and dark screens, narrow ones and paper.
#pragma once

namespace clarity::bench {

extern const char* const kReportStyle;

}  // namespace clarity::bench
